//! Names, units and comments: TX blocks and the text inside MD blocks.
//!
//! Called by the reader of the structure. A text that cannot be read is empty, and that is reported.

use std::collections::HashMap;
use std::sync::Arc;

use super::block::{BlockFile, shown};
use super::error::{Damage, Mdf4Problem, Mdf4Repair, Repairs};

/// Longest text kept, in bytes; what is behind it is cut off.
pub(super) const LONGEST: usize = 1000;

/// How much of a comment is looked through for its text.
const LOOKED_THROUGH: u64 = 1 << 16;

/// All texts together, in bytes; as much again is remembered of those that may be asked for again.
const ALL: usize = 32 << 20;

/// Texts that were read, by their place: many channels share a unit.
#[derive(Debug, Default)]
pub(super) struct Texts {
    known: HashMap<u64, Arc<str>>,
    remembered: usize,
    used: usize,
    full: bool,
}

impl Texts {
    /// The text at `at`; empty where there is none.
    pub(super) fn read(
        &mut self,
        file: &mut BlockFile,
        at: u64,
        repairs: &mut Repairs,
    ) -> Result<String, Mdf4Problem> {
        if at == 0 {
            return Ok(String::new());
        }
        let text = match self.known.get(&at) {
            Some(text) => Arc::clone(text),
            None => {
                let text: Arc<str> = match read(file, at) {
                    Ok(text) => text.into(),
                    Err(fault) => {
                        repairs.push(Mdf4Repair::Text(fault.damage()?));
                        "".into()
                    }
                };
                if self.remembered + text.len() <= ALL {
                    self.remembered += text.len();
                    self.known.insert(at, Arc::clone(&text));
                }
                text
            }
        };
        if self.used + text.len() > ALL {
            if !self.full {
                repairs.push(Mdf4Repair::TextsLeftOut { most: ALL });
                self.full = true;
            }
            return Ok(String::new());
        }
        self.used += text.len();
        Ok(text.to_string())
    }
}

pub(super) fn read(file: &mut BlockFile, at: u64) -> Result<String, super::block::Fault> {
    let frame = file.frame("text", at)?;
    let plain = match &frame.id {
        b"##TX" => true,
        b"##MD" => false,
        other => {
            let found = format!("found {}, expected \"##TX\" or \"##MD\"", shown(other));
            return Err(super::block::Fault::Damaged(Damage::new("text", at, found)));
        }
    };
    let block = file.contents("text", at, frame, LOOKED_THROUGH)?;
    let bytes = block.data.split(|byte| *byte == 0).next().unwrap_or_default();
    let text = String::from_utf8_lossy(bytes);
    Ok(if plain { shortened(text.trim()) } else { shortened(inner_text(&text).trim()) })
}

/// What stands in the first `TX` element of a comment's XML; the standard keeps the readable text there.
fn inner_text(xml: &str) -> String {
    let inside = xml.split_once("<TX").and_then(|(_, rest)| {
        let (attributes, rest) = rest.split_once('>')?;
        if attributes.ends_with('/') { Some("") } else { rest.split_once("</TX>").map(|(inside, _)| inside) }
    });
    let inside = inside.unwrap_or_default();
    // The ampersand last: what it reveals is text.
    inside
        .replace("&lt;", "<")
        .replace("&gt;", ">")
        .replace("&quot;", "\"")
        .replace("&apos;", "'")
        .replace("&amp;", "&")
}

fn shortened(text: &str) -> String {
    let kept = text.char_indices().take_while(|(at, c)| at + c.len_utf8() <= LONGEST);
    kept.map(|(_, c)| c).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_text_of_a_comment_is_what_its_first_tx_holds() {
        assert_eq!(inner_text("<CNcomment><TX>a &amp;lt; b &gt; c</TX></CNcomment>"), "a &lt; b > c");
        assert_eq!(inner_text("<CNcomment><TX xml:space=\"preserve\">two</TX><x/></CNcomment>"), "two");
        assert_eq!(inner_text("<CNcomment><TX/></CNcomment>"), "");
        assert_eq!(inner_text("<CNcomment><TX>never closed"), "");
        assert_eq!(inner_text("no xml at all"), "");
    }

    #[test]
    fn a_long_text_is_cut_between_characters() {
        let long = "ü".repeat(LONGEST);
        assert_eq!(shortened(&long).len(), LONGEST);
        assert_eq!(shortened(&format!("a{long}")).len(), LONGEST - 1);
    }
}
