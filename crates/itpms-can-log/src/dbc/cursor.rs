//! A place in the text of a DBC file: words, numbers, strings and signs, and the line they are in.
//!
//! Called by the parser of statements; does not know their meaning.

/// Found and expected.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Astray {
    pub(super) found: String,
    pub(super) expected: &'static str,
}

/// Where the reading is. Cheap to copy, to come back to a place.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cursor<'a> {
    rest: &'a str,
    pub(super) line: u64,
}

/// These stand alone; all else between blanks is a word.
const SIGNS: [char; 11] = [':', '|', '@', '(', ')', ',', '[', ']', '"', ';', '='];

impl<'a> Cursor<'a> {
    pub(super) fn new(text: &'a str) -> Self {
        Self { rest: text, line: 1 }
    }

    /// Goes to the next character that is not blank; false at the end.
    pub(super) fn skip_blanks(&mut self) -> bool {
        let trimmed = self.rest.trim_start();
        self.advance(self.rest.len() - trimmed.len());
        !self.rest.is_empty()
    }

    /// The word here, without going on; empty where there is a sign.
    pub(super) fn peek(&mut self) -> &'a str {
        self.skip_blanks();
        let end = self.rest.find(|c: char| c.is_whitespace() || SIGNS.contains(&c));
        &self.rest[..end.unwrap_or(self.rest.len())]
    }

    pub(super) fn word(&mut self, expected: &'static str) -> Result<&'a str, Astray> {
        let word = self.peek();
        if word.is_empty() {
            return Err(self.astray(expected));
        }
        self.advance(word.len());
        Ok(word)
    }

    pub(super) fn skip_word(&mut self) {
        let word = self.peek();
        self.advance(word.len());
    }

    pub(super) fn integer(&mut self, expected: &'static str) -> Result<u64, Astray> {
        let word = self.peek();
        let number = word.parse().map_err(|_| self.astray(expected))?;
        self.advance(word.len());
        Ok(number)
    }

    pub(super) fn number(&mut self, expected: &'static str) -> Result<f64, Astray> {
        let word = self.peek();
        let number = word.parse().ok().filter(|number: &f64| number.is_finite());
        let number = number.ok_or_else(|| self.astray(expected))?;
        self.advance(word.len());
        Ok(number)
    }

    pub(super) fn is_at(&mut self, sign: char) -> bool {
        self.skip_blanks();
        self.rest.starts_with(sign)
    }

    /// Whether this sign is here; goes past it.
    pub(super) fn takes(&mut self, sign: char) -> bool {
        let here = self.is_at(sign);
        if here {
            self.advance(sign.len_utf8());
        }
        here
    }

    pub(super) fn sign(&mut self, sign: char, expected: &'static str) -> Result<(), Astray> {
        if self.takes(sign) { Ok(()) } else { Err(self.astray(expected)) }
    }

    /// A string in quotes, over several lines if need be. `\"` is a quote inside it.
    pub(super) fn string(&mut self, expected: &'static str) -> Result<String, Astray> {
        self.sign('"', expected)?;
        let mut end = None;
        let mut escaped = false;
        for (i, byte) in self.rest.bytes().enumerate() {
            match byte {
                b'"' if !escaped => {
                    end = Some(i);
                    break;
                }
                _ => escaped = byte == b'\\' && !escaped,
            }
        }
        let Some(end) = end else {
            self.advance(self.rest.len());
            return Err(Astray { found: "no end of a string".to_owned(), expected: "a quote" });
        };
        let text = self.rest[..end].replace("\\\"", "\"");
        self.advance(end + 1);
        Ok(text)
    }

    /// The rest of this line, without its end.
    pub(super) fn line_rest(&mut self) -> &'a str {
        let end = self.rest.find('\n').unwrap_or(self.rest.len());
        let text = &self.rest[..end];
        self.advance(end);
        text
    }

    pub(super) fn skip_character(&mut self) {
        self.advance(self.rest.chars().next().map_or(0, char::len_utf8));
    }

    /// Something else than expected is here.
    pub(super) fn astray(&mut self, expected: &'static str) -> Astray {
        let more = self.skip_blanks();
        let found = if more { format!("{:?}", self.beginning()) } else { "the end of the file".to_owned() };
        Astray { found, expected }
    }

    pub(super) fn bytes_since(&self, earlier: &Self) -> usize {
        earlier.rest.len().saturating_sub(self.rest.len())
    }

    pub(super) fn beginning(&self) -> String {
        let line = self.rest.lines().next().unwrap_or_default();
        let clean: String = line.chars().filter(|c| !c.is_control()).take(31).collect();
        if clean.chars().count() > 30 { clean.chars().take(30).chain(['…']).collect() } else { clean }
    }

    fn advance(&mut self, bytes: usize) {
        let (past, rest) = self.rest.split_at(bytes);
        self.line += past.bytes().filter(|byte| *byte == b'\n').count() as u64;
        self.rest = rest;
    }
}
