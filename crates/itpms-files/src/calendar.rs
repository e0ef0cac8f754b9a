//! Dates and seconds since 1970, without time zones: the log formats write a date and do not say whose.
//!
//! Called by readers and writers of logs. The algorithm is the usual one of counting days in eras of 400 years
//! of the proleptic Gregorian calendar.

/// A date and a time of day.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Date {
    /// Of the Gregorian calendar, before its beginning too.
    pub year: i64,
    /// 1 to 12.
    pub month: u32,
    /// 1 to 31.
    pub day: u32,
    /// 0 to 23.
    pub hour: u32,
    /// 0 to 59.
    pub minute: u32,
    /// 0 to 60: a leap second is one.
    pub second: u32,
}

impl Date {
    /// Seconds since the beginning of 1970; `None` if there is no such date between the years 1 and 9999.
    #[must_use]
    pub fn seconds(self) -> Option<i64> {
        let plausible = (1..=9999).contains(&self.year)
            && (1..=12).contains(&self.month)
            && (1..=31).contains(&self.day)
            && self.hour < 24
            && self.minute < 60
            && self.second <= 60;
        if !plausible {
            return None;
        }
        let year = if self.month <= 2 { self.year - 1 } else { self.year };
        let era = year.div_euclid(400);
        let year_of_era = year.rem_euclid(400);
        let month_from_march = i64::from((self.month + 9) % 12);
        let day_of_year = (153 * month_from_march + 2) / 5 + i64::from(self.day) - 1;
        let day_of_era = 365 * year_of_era + year_of_era / 4 - year_of_era / 100 + day_of_year;
        let days = era * 146_097 + day_of_era - 719_468;
        let of_day = i64::from(self.hour) * 3600 + i64::from(self.minute) * 60 + i64::from(self.second);
        Some(days * 86_400 + of_day)
    }

    /// The date so many seconds after the beginning of 1970.
    #[must_use]
    pub fn of_seconds(seconds: i64) -> Self {
        let days = seconds.div_euclid(86_400) + 719_468;
        let of_day = seconds.rem_euclid(86_400) as u32;
        let era = days.div_euclid(146_097);
        let day_of_era = days.rem_euclid(146_097);
        let year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
        let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
        let month_from_march = (5 * day_of_year + 2) / 153;
        let month = if month_from_march < 10 { month_from_march + 3 } else { month_from_march - 9 } as u32;
        Self {
            year: era * 400 + year_of_era + i64::from(month <= 2),
            month,
            day: (day_of_year - (153 * month_from_march + 2) / 5 + 1) as u32,
            hour: of_day / 3600,
            minute: of_day / 60 % 60,
            second: of_day % 60,
        }
    }
}

/// Day of the week, 0 being Sunday.
#[must_use]
pub fn weekday(seconds: i64) -> usize {
    (seconds.div_euclid(86_400) + 4).rem_euclid(7) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_dates_have_their_known_seconds() {
        let at = |year, month, day, hour, minute, second| Date { year, month, day, hour, minute, second };
        // `date -u -d ... +%s`.
        for (date, seconds) in [
            (at(1970, 1, 1, 0, 0, 0), 0),
            (at(2000, 2, 29, 12, 0, 0), 951_825_600),
            (at(2015, 7, 9, 13, 4, 12), 1_436_447_052),
            (at(2026, 11, 20, 17, 17, 33), 1_795_195_053),
            (at(2100, 3, 1, 0, 0, 0), 4_107_542_400),
            (at(1969, 12, 31, 23, 59, 59), -1),
        ] {
            assert_eq!(date.seconds(), Some(seconds), "{date:?}");
            assert_eq!(Date::of_seconds(seconds), date);
        }
        assert_eq!(at(2026, 13, 1, 0, 0, 0).seconds(), None);
        assert_eq!(at(0, 1, 1, 0, 0, 0).seconds(), None);
    }

    #[test]
    fn weekdays_are_right() {
        // The first of January 1970 was a Thursday, 20 November 2026 is a Friday.
        assert_eq!((weekday(0), weekday(1_795_195_053), weekday(-1)), (4, 5, 3));
    }
}
