//! A CAN log in another format: every frame as it is.

use super::{Converted, LOOK, Look, Request, counted};
use crate::can::{FrameReader, FrameWriter};
use crate::error::DataError;

pub(super) fn convert(request: &Request<'_>, look: Look<'_>) -> Result<Option<Converted>, DataError> {
    let mut reader = FrameReader::open(request.input)?;
    let mut writer = FrameWriter::create(request.output)?;
    let mut count = 0u64;
    while let Some(frame) = reader.next_frame()? {
        if count.is_multiple_of(LOOK) && look(reader.progress()).is_break() {
            return Ok(None);
        }
        count += 1;
        writer.write(&frame)?;
    }
    let warnings = reader.repairs().warnings();
    let content = counted(count, "frame");
    Ok(Some(Converted { file: writer.finish()?, content, warnings, remarks: Vec::new() }))
}
