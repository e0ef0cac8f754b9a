//! Dates as Vector's programs write them: `Fri Nov 20 05:17:33.123 pm 2026`, in English or German. Called by the
//! reader and the writer beside it.

use itpms_files::{Date, weekday};

use crate::digits::{self, Base};
use crate::lines::Words;

const MONTHS: [&str; 12] =
    ["Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"];
const WEEKDAYS: [&str; 7] = ["Sun", "Mon", "Tue", "Wed", "Thu", "Fri", "Sat"];

/// German abbreviations that differ, the umlaut in UTF-8 and in Latin-1.
const GERMAN: [(&[u8], u32); 6] =
    [(b"M\xc3\xa4r", 3), (b"M\xe4r", 3), (b"Mrz", 3), (b"Mai", 5), (b"Okt", 10), (b"Dez", 12)];

/// Seconds since 1970 of a date; `None` if it is none.
pub(super) fn parse(text: &[u8]) -> Option<f64> {
    let mut words = Words::new(text);
    // The name of the weekday says nothing new and may be in any language.
    let month = [words.next()?, words.next()?].into_iter().find_map(month);
    let (month, day) = (month?, digits::unsigned(words.next()?, Base::Decimal)?);
    let (hour, minute, second, fraction_s) = time_of_day(words.next()?)?;
    let mut last = words.next()?;
    let hour = if last.eq_ignore_ascii_case(b"am") || last.eq_ignore_ascii_case(b"pm") {
        let is_afternoon = last.eq_ignore_ascii_case(b"pm");
        last = words.next()?;
        hour % 12 + if is_afternoon { 12 } else { 0 }
    } else {
        hour
    };
    let year = digits::unsigned(last, Base::Decimal)?.into();
    let whole_s = Date { year, month, day, hour, minute, second }.seconds()?;
    Some(whole_s as f64 + fraction_s)
}

fn month(name: &[u8]) -> Option<u32> {
    let english = MONTHS.iter().position(|month| name.eq_ignore_ascii_case(month.as_bytes()));
    let german = || GERMAN.iter().find(|(german, _)| *german == name).map(|(_, number)| *number);
    english.map(|index| index as u32 + 1).or_else(german)
}

/// `15:06:13.191`, the fraction as a decimal fraction however many digits it has.
fn time_of_day(text: &[u8]) -> Option<(u32, u32, u32, f64)> {
    let mut fields = text.splitn(3, |byte| *byte == b':');
    let mut number = || digits::unsigned(fields.next()?, Base::Decimal);
    let (hour, minute) = (number()?, number()?);
    let last = fields.next()?;
    let whole = last.iter().position(|byte| *byte == b'.').unwrap_or(last.len());
    let (second, fraction) = last.split_at(whole);
    let fraction_s = if fraction.is_empty() { 0.0 } else { digits::seconds(fraction)? };
    Some((hour, minute, digits::unsigned(second, Base::Decimal)?, fraction_s))
}

/// A whole second as a date, with 24 hours a day and three digits after the second.
pub(super) fn format(seconds: i64) -> String {
    let date = Date::of_seconds(seconds);
    let month = MONTHS.get(date.month as usize - 1).copied().unwrap_or("Jan");
    let day_name = WEEKDAYS.get(weekday(seconds)).copied().unwrap_or("Sun");
    format!(
        "{day_name} {month} {:02} {:02}:{:02}:{:02}.000 {}",
        date.day, date.hour, date.minute, date.second, date.year
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_are_read_in_both_languages_and_both_clocks() {
        // `date -u -d ... +%s`.
        for (text, seconds) in [
            ("Sat Sep 30 15:06:13.191 2017", 1_506_783_973.191),
            ("Sam Sep 30 03:06:13.191 pm 2017", 1_506_783_973.191),
            ("Thu Apr 28 12:44:52.480 am 2022", 1_651_106_692.48),
            ("Thu Apr 28 12:44:52 pm 2022", 1_651_149_892.0),
            ("Die M\u{e4}r 8 00:00:00 2022", 1_646_697_600.0),
            ("Fre Okt 1 00:00:00.5 2021", 1_633_046_400.5),
        ] {
            assert_eq!(parse(text.as_bytes()), Some(seconds), "{text}");
        }
        for text in [
            "",
            "yesterday",
            "Sat Foo 30 15:06:13 2017",
            "Sat Sep 31x 15:06:13 2017",
            "Sat Sep 30 25:06:13 2017",
        ] {
            assert_eq!(parse(text.as_bytes()), None, "{text}");
        }
    }

    #[test]
    fn a_date_that_is_written_is_read_again() {
        for seconds in [0, 951_825_600, 1_795_195_053, 253_402_300_799] {
            assert_eq!(parse(format(seconds).as_bytes()), Some(seconds as f64));
        }
        assert_eq!(format(1_795_195_053), "Fri Nov 20 17:17:33.000 2026");
    }
}
