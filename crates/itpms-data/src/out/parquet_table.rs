//! The table as Parquet: optional columns (a missing number is a null), zstd, row groups of bounded size.

use std::sync::Arc;

use itpms_files::AtomicFile;
use parquet::basic::{Compression, ConvertedType, Repetition, Type as PhysicalType};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DoubleType};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;

use super::cell::{Cell, Kind};
use crate::error::{DataError, FileProblem};

/// Rows held in memory until they are written: 18 columns of them are 9 MB.
const ROWS_PER_GROUP: usize = 65_536;

/// The values of one column since the last row group.
#[derive(Debug)]
enum Buffer {
    /// Values that are there, and for every row whether it is.
    Numbers {
        present: Vec<i16>,
        values: Vec<f64>,
    },
    Flags(Vec<bool>),
    Labels(Vec<ByteArray>),
}

impl Buffer {
    fn new(kind: Kind) -> Self {
        match kind {
            Kind::Number => Buffer::Numbers { present: Vec::new(), values: Vec::new() },
            Kind::Flag => Buffer::Flags(Vec::new()),
            Kind::Label => Buffer::Labels(Vec::new()),
        }
    }

    fn push(&mut self, cell: Cell<'_>) {
        match (self, cell) {
            (Buffer::Numbers { present, values }, Cell::Number(value)) => {
                present.push(i16::from(!value.is_nan()));
                if !value.is_nan() {
                    values.push(value);
                }
            }
            (Buffer::Flags(flags), Cell::Flag(flag)) => flags.push(flag),
            (Buffer::Labels(labels), Cell::Label(label)) => {
                labels.push(ByteArray::from(label.as_bytes().to_vec()))
            }
            _ => debug_assert!(false, "a cell of another kind than its column"),
        }
    }

    fn clear(&mut self) {
        match self {
            Buffer::Numbers { present, values } => {
                present.clear();
                values.clear();
            }
            Buffer::Flags(flags) => flags.clear(),
            Buffer::Labels(labels) => labels.clear(),
        }
    }
}

pub(super) struct ParquetTable {
    target: std::path::PathBuf,
    writer: SerializedFileWriter<AtomicFile>,
    buffers: Vec<Buffer>,
    rows: usize,
}

impl std::fmt::Debug for ParquetTable {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ParquetTable").field("target", &self.target).finish_non_exhaustive()
    }
}

impl ParquetTable {
    pub(super) fn new(file: AtomicFile, columns: &[(String, Kind)]) -> Result<Self, DataError> {
        let target = file.target().to_owned();
        let properties = WriterProperties::builder()
            .set_compression(Compression::ZSTD(Default::default()))
            // Measured values hardly ever repeat; a dictionary would only be built to be given up.
            .set_dictionary_enabled(false)
            .build();
        let writer = schema(columns)
            .and_then(|schema| SerializedFileWriter::new(file, Arc::new(schema), Arc::new(properties)))
            .map_err(|error| write_error(&target, error))?;
        let buffers = columns.iter().map(|(_, kind)| Buffer::new(*kind)).collect();
        Ok(Self { target, writer, buffers, rows: 0 })
    }

    pub(super) fn write(&mut self, cells: &[Cell<'_>]) -> Result<(), DataError> {
        debug_assert_eq!(cells.len(), self.buffers.len());
        for (buffer, cell) in self.buffers.iter_mut().zip(cells) {
            buffer.push(*cell);
        }
        self.rows += 1;
        if self.rows >= ROWS_PER_GROUP {
            self.write_group().map_err(|error| write_error(&self.target, error))?;
        }
        Ok(())
    }

    pub(super) fn finish(mut self: Box<Self>) -> Result<AtomicFile, DataError> {
        if self.rows > 0 {
            self.write_group().map_err(|error| write_error(&self.target, error))?;
        }
        let mut file = self.writer.into_inner().map_err(|error| write_error(&self.target, error))?;
        file.settle()?;
        Ok(file)
    }

    fn write_group(&mut self) -> Result<(), ParquetError> {
        let mut group = self.writer.next_row_group()?;
        for buffer in &mut self.buffers {
            let Some(mut column) = group.next_column()? else { break };
            match buffer {
                Buffer::Numbers { present, values } => {
                    column.typed::<DoubleType>().write_batch(values, Some(present), None)?
                }
                Buffer::Flags(flags) => column.typed::<BoolType>().write_batch(flags, None, None)?,
                Buffer::Labels(labels) => column.typed::<ByteArrayType>().write_batch(labels, None, None)?,
            };
            column.close()?;
            buffer.clear();
        }
        group.close()?;
        self.rows = 0;
        Ok(())
    }
}

fn schema(columns: &[(String, Kind)]) -> Result<Type, ParquetError> {
    let fields = columns.iter().map(|(name, kind)| {
        let (physical, converted, repetition) = match kind {
            Kind::Number => (PhysicalType::DOUBLE, ConvertedType::NONE, Repetition::OPTIONAL),
            Kind::Flag => (PhysicalType::BOOLEAN, ConvertedType::NONE, Repetition::REQUIRED),
            Kind::Label => (PhysicalType::BYTE_ARRAY, ConvertedType::UTF8, Repetition::REQUIRED),
        };
        Type::primitive_type_builder(name, physical)
            .with_repetition(repetition)
            .with_converted_type(converted)
            .build()
            .map(Arc::new)
    });
    Type::group_type_builder("table").with_fields(fields.collect::<Result<_, _>>()?).build()
}

/// An I/O error keeps its own words ("No space left on device"), without the library's wrapping.
fn write_error(target: &std::path::Path, error: ParquetError) -> DataError {
    let error = match error {
        ParquetError::External(inner) => match inner.downcast::<std::io::Error>() {
            Ok(io) => *io,
            Err(other) => std::io::Error::other(other),
        },
        other => std::io::Error::other(other),
    };
    DataError::new(target, FileProblem::Write(error))
}
