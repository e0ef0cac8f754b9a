//! Columns that a frame of SAE J1939 has not as one signal: the speed of a wheel beside that of the front axle (EBC2), and the pressure, or
//! temperature, of whichever tire a frame is of (TIRE). Wheels beyond two axles with a tire on each side are not read.
//!
//! Facts of SAE J1939-71: relative speeds are against the front axle's; a tire's location counts axles from the front in its upper four
//! bits and tires from the left in its lower ones, both from zero.

use itpms_core::model::Corner;

use super::{Dbc, Message};
use crate::signals::Candidate;
use crate::signals::names::{Part, part};

/// A column made of two signals of a message.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Compound {
    pub(crate) candidate: Candidate,
    /// Place of the message in the description, and of the signal in it.
    pub(super) message: usize,
    pub(super) place: usize,
    pub(super) how: How,
}

/// Effect of the other signal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum How {
    /// The value of the signal at this place is added.
    Plus(usize),
    /// The signal at this place says of which tire it is; it has to be of this corner.
    At(usize, Corner),
    /// The same of an axle, from the front.
    OnAxle(usize, u64),
}

/// All of a description's, after its own signals.
pub(crate) fn compounds(dbc: &Dbc) -> Vec<Compound> {
    let mut found = Vec::new();
    for (number, message) in dbc.messages().iter().enumerate().filter(|(_, message)| message.id.is_extended())
    {
        let parts = parts(message);
        let place_of = |wanted: Part| parts.iter().find(|(_, part)| *part == wanted).map(|(place, _)| *place);
        let (axle, location) = (place_of(Part::FrontAxleSpeed), place_of(Part::TireLocation));
        let axle_location = place_of(Part::AxleLocation);
        for (place, part) in &parts {
            let signal = &message.signals[*place];
            let mut push = |name: String, how| {
                let (group, unit) = (message.name.clone(), signal.unit.clone());
                let candidate = Candidate { group, name, unit };
                found.push(Compound { candidate, message: number, place: *place, how });
            };
            match (part, axle, location) {
                (Part::RelativeSpeed, Some(axle), _) if message.signals[axle].unit == signal.unit => {
                    let name = format!("{} + {}", signal.name, message.signals[axle].name);
                    push(name, How::Plus(axle));
                }
                (Part::TirePressure | Part::TireTemperature, _, Some(location)) => {
                    for (corner, at) in
                        Corner::ALL.into_iter().zip(["front left", "front right", "rear left", "rear right"])
                    {
                        push(format!("{} {at}", signal.name), How::At(location, corner));
                    }
                }
                (Part::AxleWeight, ..) => {
                    for (axle, at) in (0..).zip(["front", "rear"]) {
                        if let Some(location) = axle_location {
                            push(format!("{} {at}", signal.name), How::OnAxle(location, axle));
                        }
                    }
                }
                _ => {}
            }
        }
    }
    found
}

/// The places of signals that are part of something.
fn parts(message: &Message) -> Vec<(usize, Part)> {
    let part = |place: usize| Some((place, part(&message.signals[place].name)?));
    message.first_layouts().filter_map(part).collect()
}

/// Wheels that a car of two axles with a tire on each side has not, as their frames come.
#[derive(Debug, Clone, Default)]
pub(super) struct Beyond {
    /// Relative speeds of further axles, with a value.
    speeds: Vec<usize>,
    /// Locations that were seen, and axles with more than two tires.
    seen: [u64; 4],
    dual: u16,
}

impl Beyond {
    pub(super) fn of(message: &Message) -> Self {
        let further = |(place, part)| (part == Part::FurtherSpeed).then_some(place);
        Self { speeds: parts(message).into_iter().filter_map(further).collect(), ..Self::default() }
    }

    /// Whether these data have the speed of such a wheel.
    pub(super) fn has_speed(&self, message: &Message, data: &[u8]) -> bool {
        let sent = |place: &usize| {
            message.raw(*place, data).is_some_and(|raw| !message.signals[*place].is_not_available(raw))
        };
        self.speeds.iter().any(sent)
    }

    /// The corner of a tire's location, `Err` of one that such a car has not. A location counts from its second time on: by then all tires
    /// of an axle have come once, and two on a side are known as such.
    pub(super) fn corner(&mut self, location: u64) -> Result<Option<Corner>, ()> {
        let (axle, tire) = (location >> 4, location & 0xF);
        let (word, bit) = ((location >> 6) as usize & 3, 1 << (location & 63));
        if location > 0xFF {
            return Err(());
        }
        let again = self.seen[word] & bit != 0;
        self.seen[word] |= bit;
        if tire > 1 {
            self.dual |= 1 << (axle & 0xF);
        }
        if axle > 1 || self.dual >> axle & 1 != 0 {
            return Err(());
        }
        Ok(again.then(|| Corner::ALL[(2 * axle + tire) as usize]))
    }
}
