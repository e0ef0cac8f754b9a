//! Times that are written as dates, or as days and a clock: what pandas, polars and many loggers write into CSV.

use itpms_files::Date;

/// Seconds since 1970 of `2026-03-01 08:00:00.002`, with `T` or a blank, with `Z`, an offset or nothing (taken for UTC) after
/// it, or with the date as `01.03.2026`, as `01-Mar-2026`, or as `03/01/2026 08:00:00 AM`; or the seconds of `0 days 00:00:01.5`, of `00:00:01.5` and of MATLAB's `1.5 sec`.
pub(crate) fn seconds(text: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(text).ok()?.trim();
    if let Some(stamp) = java_stamp_s(text).or_else(|| digits_s(text)) {
        return Some(stamp);
    }
    let text = text.strip_suffix("UTC").or_else(|| text.strip_suffix("GMT")).unwrap_or(text).trim_end();
    if let Some(seconds) = text.strip_suffix(" sec") {
        return seconds.trim_end().parse().ok().filter(|seconds: &f64| seconds.is_finite());
    }
    if let Some((days, clock)) = text.split_once(" days ") {
        let (days, clock) = (days.parse::<i64>().ok()?, clock.trim_start_matches('+'));
        return Some(days as f64 * 86_400.0 + clock_s(clock)?);
    }
    if let Some((date, clock)) = text.strip_suffix('M').and_then(|text| text.split_once(' ')) {
        let half_day_s = if clock.ends_with('P') { 43_200.0 } else { 0.0 };
        let clock = clock.strip_suffix(['A', 'P'])?.trim_end();
        let clock_s = clock_s(clock).filter(|clock_s| (3600.0..46_800.0).contains(clock_s))?;
        return Some(american_days_since_1970(date)? as f64 * 86_400.0 + clock_s % 43_200.0 + half_day_s);
    }
    let Some((date, rest)) = text.split_once(['T', ' ']) else { return clock_s(text) };
    let days = days_since_1970(date)?;
    let (clock, offset_s) = match rest.find(['Z', '+', '-']) {
        None => (rest, 0.0),
        Some(place) if &rest[place..] == "Z" => (&rest[..place], 0.0),
        Some(place) => {
            let (sign, offset) = rest[place..].split_at(1);
            let seconds = offset_s(offset)?;
            (&rest[..place], if sign == "-" { -seconds } else { seconds })
        }
    };
    Some(days as f64 * 86_400.0 + clock_s(clock.trim_end())? - offset_s)
}

/// `Wed Aug 05 18:57:46 GMT+01:00 2026`, as Java writes a point in time.
fn java_stamp_s(text: &str) -> Option<f64> {
    let mut parts = text.split_ascii_whitespace();
    let (_, month, day) = (parts.next()?, parts.next()?, parts.next()?);
    let (clock, zone, year) = (parts.next()?, parts.next()?, parts.next()?);
    let days = days_since_1970(&format!("{day}-{month}-{year}")).filter(|_| parts.next().is_none())?;
    let offset = zone.strip_prefix("GMT").or(zone.strip_prefix("UTC"))?;
    let offset_s = match offset.split_at_checked(1) {
        None => 0.0,
        Some(("-", offset)) => -offset_s(offset)?,
        Some((_, offset)) => offset_s(offset)?,
    };
    Some(days as f64 * 86_400.0 + clock_s(clock)? - offset_s)
}

/// `20260301080000.002`, digits alone: with so many of them it is no number of seconds.
fn digits_s(text: &str) -> Option<f64> {
    let (whole, fraction) = text.split_once('.').unwrap_or((text, "0"));
    let all_digits = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    if whole.len() != 14 || !all_digits(whole) || !all_digits(fraction) {
        return None;
    }
    let part = |from: usize, to: usize| whole.get(from..to);
    let days = days_since_1970(&format!("{}-{}-{}", part(0, 4)?, part(4, 6)?, part(6, 8)?))?;
    let clock = clock_s(&format!("{}:{}:{}.{fraction}", part(8, 10)?, part(10, 12)?, part(12, 14)?))?;
    Some(days as f64 * 86_400.0 + clock)
}

/// `01:00`, `0100` or `01`.
fn offset_s(text: &str) -> Option<f64> {
    let (hours, minutes) = match (text.split_once(':'), text.len()) {
        (Some(parts), _) => parts,
        (None, 4) => text.split_at_checked(2)?,
        (None, 2) => (text, "00"),
        _ => return None,
    };
    clock_s(&format!("{hours}:{minutes}:00"))
}

/// `08:00:00.002`.
fn clock_s(text: &str) -> Option<f64> {
    let mut parts = text.split(':');
    let (hours, minutes, seconds) = (parts.next()?, parts.next()?, parts.next()?);
    let whole = |part: &str, most: u32| part.parse::<u32>().ok().filter(|value| *value <= most);
    // A decimal comma, as German loggers and Python's logging have it.
    let seconds: f64 =
        seconds.replace(',', ".").parse().ok().filter(|seconds| (0.0..61.0).contains(seconds))?;
    let minutes = f64::from(60 * whole(hours, 23)? + whole(minutes, 59)?);
    parts.next().is_none().then_some(60.0 * minutes + seconds)
}

/// Days from 1970-01-01 to `MM/DD/YYYY`, which has that order where the clock has twelve hours.
fn american_days_since_1970(date: &str) -> Option<i64> {
    let mut parts = date.split('/');
    let (month, day, year) = (parts.next()?, parts.next()?, parts.next()?);
    days_since_1970(&format!("{year}-{month}-{day}")).filter(|_| parts.next().is_none())
}

const MONTHS: [&str; 12] =
    ["jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec"];

/// Days from 1970-01-01 to `YYYY-MM-DD`, `YYYY/MM/DD`, `DD.MM.YYYY` or `DD-Mon-YYYY` in the Gregorian calendar.
fn days_since_1970(date: &str) -> Option<i64> {
    let german = date.contains('.');
    let separator = ['.', '/', '-'].into_iter().find(|separator| date.contains(*separator))?;
    let mut parts = date.split(separator);
    let (first, month, last) = (parts.next()?, parts.next()?, parts.next()?);
    let named = MONTHS.iter().position(|name| month.to_ascii_lowercase() == *name);
    let month = named.map_or_else(|| month.to_owned(), |place| (place + 1).to_string());
    let (year, day) =
        if german || named.is_some() && first.len() < 3 { (last, first) } else { (first, last) };
    let (year, month, day) = (year.parse().ok()?, month.parse().ok()?, day.parse().ok()?);
    let date = Date { year, month, day, hour: 0, minute: 0, second: 0 };
    let seconds = date.seconds().filter(|_| parts.next().is_none() && (1900..2500).contains(&year))?;
    // The day after the last of a month is the next one's.
    (Date::of_seconds(seconds) == date).then_some(seconds / 86_400)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_as_unix_counts_them() {
        // As `date -u -d ... +%s` has them.
        for (text, expected) in [
            ("1970-01-01T00:00:00Z", 0.0),
            ("2000-02-29 12:00:00", 951_825_600.0),
            ("2026-03-01 08:00:00.25", 1_772_352_000.25),
            ("2026-03-01T09:00:00+01:00", 1_772_352_000.0),
            ("2026-03-01T02:30:00-05:30", 1_772_352_000.0),
            ("2026-03-01T09:00:00+0100", 1_772_352_000.0),
            ("2026-03-01 08:00:00+00", 1_772_352_000.0),
            ("2026-03-01 08:00:00+0000", 1_772_352_000.0),
            ("2026-03-01 08:00:00 UTC", 1_772_352_000.0),
            ("2026-03-01 08:00:00,250", 1_772_352_000.25),
            ("2100-03-01 00:00:00", 4_107_542_400.0),
            ("0 days 00:00:01.500000", 1.5),
            ("0.002 sec", 0.002),
            ("01.03.2026 08:00:00,25", 1_772_352_000.25),
            ("03/01/2026 08:00:00.25 AM", 1_772_352_000.25),
            ("3/1/2026 08:00:00PM", 1_772_395_200.0),
            ("03/01/2026 12:00:00 AM", 1_772_323_200.0),
            ("03/01/2026 12:00:00 PM", 1_772_366_400.0),
            ("01-Mar-2026 08:00:00.25", 1_772_352_000.25),
            ("2026/03/01 08:00:00.25", 1_772_352_000.25),
            ("Sun Mar 01 09:00:00 GMT+01:00 2026", 1_772_352_000.0),
            ("20260301080000.25", 1_772_352_000.25),
            ("1 days 00:00:00", 86_400.0),
            ("01:02:03.5", 3723.5),
        ] {
            assert_eq!(seconds(text.as_bytes()), Some(expected), "{text}");
        }
    }

    #[test]
    fn what_is_no_time_is_none() {
        for text in [
            "",
            "now",
            "2026-03-01",
            "2026-02-29 00:00:00",
            "2026-13-01 00:00:00",
            "25:00:00",
            "1,5",
            "12:30",
            "1:2:3:4",
            "NaN:0:0",
            "03/01/2026 08:00:00",
            "31/01/2026 08:00:00 AM",
            "03/01/2026 13:00:00 PM",
            "03/01/2026 00:30:00 AM",
            "AM",
        ] {
            assert_eq!(seconds(text.as_bytes()), None, "{text}");
        }
    }
}
