//! Rows of a table of pulses from text and from Parquet: a place, a time in s (NaN where it is missing), a wheel's index.

use std::path::Path;

use itpms_core::model::Corner;
use itpms_files::{input, nearest};

use crate::error::{DataError, Place, Problem};
use crate::log::{Format, Lines, TextHead, shortened};
#[cfg(feature = "parquet")]
use crate::parquet_columns::ParquetColumns;

const TIME: &str = "time_s";
const WHEEL: &str = "wheel";

type Row = (Place, f64, usize);

#[derive(Debug)]
pub(super) enum Source {
    Text(Box<TextSource>),
    #[cfg(feature = "parquet")]
    Parquet(Box<ParquetColumns>),
}

#[derive(Debug)]
pub(super) struct TextSource {
    lines: Lines,
    head: TextHead,
    columns: [usize; 2],
    cut_off: bool,
}

impl Source {
    pub(super) fn open(path: &Path) -> Result<Self, DataError> {
        let format = Format::of(path)?;
        let open = || match format {
            Format::Csv => TextSource::open(path).map(|source| Self::Text(Box::new(source))),
            #[cfg(feature = "parquet")]
            Format::Parquet => open_parquet(path),
        };
        open().map_err(|problem| DataError::new(path, problem))
    }

    pub(super) fn next_row(&mut self) -> Result<Option<Row>, Problem> {
        match self {
            Self::Text(source) => source.next_row(),
            #[cfg(feature = "parquet")]
            Self::Parquet(columns) => {
                let Some(place) = columns.advance()? else { return Ok(None) };
                let mut values = columns.values();
                let (time_s, wheel) = (values.next().unwrap_or(f64::NAN), values.next().unwrap_or(f64::NAN));
                if !(wheel >= 0.0) {
                    let found = if wheel.is_nan() { "nothing" } else { "another word" };
                    return Err(no_wheel(place, found));
                }
                Ok(Some((place, time_s, wheel as usize)))
            }
        }
    }

    /// Whether the last line has no end.
    pub(super) fn cut_off(&self) -> bool {
        matches!(self, Self::Text(source) if source.cut_off)
    }
}

#[cfg(feature = "parquet")]
fn open_parquet(path: &Path) -> Result<Source, Problem> {
    let mut columns = ParquetColumns::open(input::open_regular(path, "Parquet")?.0)?;
    let [time, wheel] = places(columns.names())?;
    columns.choose_clock(time)?;
    const WHEELS: [&str; 4] =
        [Corner::ALL[0].label(), Corner::ALL[1].label(), Corner::ALL[2].label(), Corner::ALL[3].label()];
    columns.choose_words(wheel, &WHEELS)?;
    Ok(Source::Parquet(Box::new(columns)))
}

fn no_wheel(place: Place, found: &str) -> Problem {
    Problem::Refused(format!("{place}, column wheel: found {found}, expected fl, fr, rl or rr"))
}

fn places(names: &[String]) -> Result<[usize; 2], Problem> {
    let place = |column: &'static str| {
        let mut of = names.iter().enumerate().filter(|(_, name)| name.trim().eq_ignore_ascii_case(column));
        let Some((index, _)) = of.next() else {
            let nearest = nearest(column, names.iter().map(String::as_str));
            let hint = nearest.map(|name| format!("; the nearest name there is {name}")).unwrap_or_default();
            let found = names.join(", ").replace(|c: char| c.is_control(), " ");
            return Err(format!(
                "found the columns {found}, expected time_s and wheel: {column} is missing{hint}"
            ));
        };
        let is_one = of.next().is_none();
        if is_one { Ok(index) } else { Err(format!("two columns are called {column}, expected one")) }
    };
    Ok([place(TIME)?, place(WHEEL)?])
}

impl TextSource {
    fn open(path: &Path) -> Result<Self, Problem> {
        let mut lines = Lines::new(input::open(path)?.0);
        let head = TextHead::read(&mut lines)?
            .ok_or("the file is empty, expected a header line with time_s and wheel")?;
        let columns = places(&head.names)?;
        let unit = head.units.get(columns[0]).map(|unit| unit.trim_matches(['[', ']']));
        match unit {
            None | Some("" | "-" | "s") => {}
            Some(other) => return Err(format!("the unit of time_s is {other:?}, expected s").into()),
        }
        Ok(Self { lines, head, columns, cut_off: false })
    }

    fn next_row(&mut self) -> Result<Option<Row>, Problem> {
        loop {
            if !self.lines.advance()? {
                return Ok(None);
            }
            if !self.head.is_names(self.lines.text()) {
                break;
            }
        }
        let place = Place::Line(self.lines.number());
        let [time, wheel] = self.columns;
        let (mut cells, mut found) = ([None; 2], 0);
        for cell in self.head.dialect.cells(self.lines.text()) {
            if found == time {
                cells[0] = Some(cell);
            } else if found == wheel {
                cells[1] = Some(cell);
            }
            found += 1;
        }
        let expected = self.head.names.len();
        // A logger that lost its power.
        if !self.lines.is_terminated() {
            self.cut_off = true;
            return Ok(None);
        }
        let [Some(time), Some(wheel)] = cells else {
            return Err(Problem::CellCount { place, found, expected });
        };
        if found != expected {
            return Err(Problem::CellCount { place, found, expected });
        }
        let shown = |cell: &[u8]| shortened(&String::from_utf8_lossy(cell));
        let time_s = self.head.dialect.number(time).ok_or_else(|| Problem::NotANumber {
            place,
            column: TIME.to_owned(),
            found: shown(time),
            hint: "",
        })?;
        let is = |corner: &Corner| wheel.eq_ignore_ascii_case(corner.label().as_bytes());
        let index = Corner::ALL.iter().position(is);
        let wheel = index.ok_or_else(|| no_wheel(place, &format!("{:?}", shown(wheel))))?;
        Ok(Some((place, time_s, wheel)))
    }
}
