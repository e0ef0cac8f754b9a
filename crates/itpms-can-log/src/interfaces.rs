//! Which bus an interface of a log is. Called by the reader of candump's lines.

use super::repairs::FrameRepairs;

/// Names seen in a log, each with its number.
#[derive(Debug, Default)]
pub(super) struct Interfaces {
    known: Vec<(String, u16)>,
}

/// Names kept; a car has fewer buses. Beyond it the number in the name alone counts.
const MOST: usize = 64;

impl Interfaces {
    /// The bus of a name whose own number is `wished`: that number, unless another name has it already.
    pub(super) fn bus(&mut self, name: &str, wished: u16, repairs: &mut FrameRepairs) -> u16 {
        if let Some((_, bus)) = self.known.iter().find(|(known, _)| known == name) {
            return *bus;
        }
        if self.known.len() >= MOST {
            return wished;
        }
        let is_taken = |bus: u16| self.known.iter().any(|(_, known)| *known == bus);
        let bus = if is_taken(wished) {
            let free = (0..=u16::MAX).find(|bus| !is_taken(*bus)).unwrap_or(wished);
            repairs.assume(format!("interface {name} is taken as bus {free}; another one is bus {wished}"));
            free
        } else {
            wished
        };
        self.known.push((name.to_owned(), bus));
        bus
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_interfaces_are_two_buses() {
        let mut repairs = FrameRepairs::default();
        let mut interfaces = Interfaces::default();
        assert_eq!(interfaces.bus("can0", 0, &mut repairs), 0);
        assert_eq!(interfaces.bus("can1", 1, &mut repairs), 1);
        assert!(repairs.assumptions.is_empty());
        assert_eq!(interfaces.bus("vcan1", 1, &mut repairs), 2);
        assert_eq!(interfaces.bus("can1", 1, &mut repairs), 1);
        assert_eq!(repairs.assumptions.len(), 1);
    }
}
