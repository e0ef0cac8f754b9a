//! The columns of a drive log, row by row.

use super::{Converted, LOOK, Look, Request, counted};
use crate::error::DataError;
use crate::log::{LogFormat, LogOptions, LogReader, PositionColumns};
use crate::out::LogWriter;

pub(super) fn convert(request: &Request<'_>, look: Look<'_>) -> Result<Option<Converted>, DataError> {
    let mut log = LogReader::open_with(request.input, &for_reading(request)?)?;
    let columns = if request.position { log.columns().with_position() } else { *log.columns() };
    let mut writer = LogWriter::create_with(request.output, columns, request.options, request.packing)?;
    writer.set_start_ns(log.start_ns());
    let mut count = 0u64;
    while let Some(row) = log.next_row()? {
        if count.is_multiple_of(LOOK) && look(log.progress()).is_break() {
            return Ok(None);
        }
        count += 1;
        writer.write(&row)?;
    }
    let mut warnings = log.repairs().warnings();
    warnings.extend(writer.losses());
    let mut remarks = log.mapping().to_vec();
    remarks.extend(log.remarks());
    if columns.motion.position == PositionColumns::Private {
        remarks.push(
            "latitude_deg and longitude_deg are left out, expected --positions where they are to be kept"
                .to_owned(),
        );
    }
    Ok(Some(Converted { file: writer.finish()?, content: counted(count, "row"), warnings, remarks }))
}

/// The signal options that apply to reading; the others apply to the output file.
fn for_reading(request: &Request<'_>) -> Result<LogOptions, DataError> {
    let mut options = request.options.clone();
    match LogFormat::of_log(request.input, options.dbc.as_deref())? {
        // For a CAN log the map says which columns go into which of the DBC file's signals.
        LogFormat::Table(_) if options.dbc.is_some() => (options.dbc, options.signals) = (None, None),
        LogFormat::Table(_) => {}
        #[cfg(feature = "mdf4")]
        LogFormat::Mdf4 if options.dbc.is_some() => (options.dbc, options.signals) = (None, None),
        #[cfg(feature = "mdf4")]
        LogFormat::Mdf4 => {}
        #[cfg(feature = "can")]
        LogFormat::Can => {}
        #[cfg(feature = "mcap")]
        LogFormat::Mcap if options.dbc.is_some() => (options.dbc, options.signals) = (None, None),
        #[cfg(feature = "mcap")]
        LogFormat::Mcap => {}
    }
    Ok(options)
}
