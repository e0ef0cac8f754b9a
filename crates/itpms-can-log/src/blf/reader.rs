//! A BLF file as frames. Called by `FrameReader`; puts the pieces of the stream of objects together and takes them apart at the objects.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};

use itpms_files::FileProblem;

use super::bytes::{find, u32_at};
use super::container::{self, Containers, Piece};
use super::header::{self, Header};
use super::object::{self, MOST_FRAME_BYTES, Object};
use super::{BASE_HEADER, SIGNATURE};
use crate::error::CanProblem;
use crate::frame::CanFrame;
use crate::frame_source::FrameSource;
use crate::repairs::{FramePlace, FrameRepairs};

/// [`container::MOST_PADDING`] in memory.
const MOST_PADDING: usize = container::MOST_PADDING as usize;

#[derive(Debug)]
pub(crate) struct BlfReader {
    containers: Containers,
    start_s: f64,
    /// Uncompressed objects, used up to `at`.
    buffer: Vec<u8>,
    at: usize,
    /// Bytes of a long object that are still to be passed over.
    skip: usize,
    /// The piece in the making.
    piece: Vec<u8>,
    any_object: bool,
    is_over: bool,
}

/// The object at a position of the stream.
enum Step {
    /// An object of ours: padding before it, its size.
    Frame(usize, usize),
    /// Another object: bytes up to its end.
    Other(usize),
    /// Nothing that is an object: bytes to pass over.
    Stray(usize),
    /// More bytes are needed to tell.
    More,
}

impl BlfReader {
    pub(crate) fn new(mut file: File, bytes: u64) -> Result<Self, CanProblem> {
        let mut start = Vec::new();
        (&mut file).take(header::LEAST as u64).read_to_end(&mut start).map_err(FileProblem::Read)?;
        if start.is_empty() {
            return Err(CanProblem::Empty { expected: "a BLF header that begins with LOGG" });
        }
        let header = Header::read(&start).ok_or_else(|| CanProblem::NoHeader {
            found: start.get(..4).unwrap_or(&start).escape_ascii().to_string(),
            bytes,
        })?;
        // A size that cannot be is as good as the usual one: the first object is searched for.
        let size = u64::from(header.size);
        let first = if (header::LEAST as u64..=bytes).contains(&size) { size } else { header::LEAST as u64 };
        file.seek(SeekFrom::Start(first)).map_err(FileProblem::Read)?;
        Ok(Self {
            containers: Containers::new(file, first, bytes),
            start_s: header.start_s,
            buffer: Vec::new(),
            at: 0,
            skip: 0,
            piece: Vec::new(),
            any_object: false,
            is_over: false,
        })
    }

    fn step(&self) -> Step {
        let ahead = self.buffer.get(self.at..).unwrap_or_default();
        let near = ahead.get(..MOST_PADDING + SIGNATURE.len()).unwrap_or(ahead);
        let Some(padding) = find(near, SIGNATURE) else {
            return if near.len() < MOST_PADDING + SIGNATURE.len() {
                Step::More
            } else {
                // The last bytes may be the beginning of a signature.
                Step::Stray(find(ahead, SIGNATURE).unwrap_or(ahead.len() - (SIGNATURE.len() - 1)))
            };
        };
        let object = ahead.get(padding..).unwrap_or_default();
        if object.len() < BASE_HEADER {
            return Step::More;
        }
        let size = u32_at(object, 8).unwrap_or(0) as usize;
        let is_frame = u32_at(object, 12).is_some_and(object::is_frame);
        if size < BASE_HEADER || (is_frame && size > MOST_FRAME_BYTES) {
            // Past this signature, so that the next one is found.
            Step::Stray(padding + SIGNATURE.len())
        } else if !is_frame {
            Step::Other(padding + size)
        } else if object.len() < size {
            Step::More
        } else {
            Step::Frame(padding, size)
        }
    }

    /// Passes over so many bytes, also such that are not here yet.
    fn pass(&mut self, size: usize) {
        let here = size.min(self.buffer.len() - self.at);
        self.at += here;
        self.skip = size - here;
    }

    /// Gets the next piece; false at the end of the file.
    fn refill(&mut self, repairs: &mut FrameRepairs) -> io::Result<bool> {
        self.buffer.drain(..self.at);
        self.at = 0;
        match self.containers.next(&mut self.piece, repairs)? {
            Piece::End => {
                self.is_over = true;
                return Ok(false);
            }
            Piece::Object | Piece::AfterGap => {
                if self.buffer.len() > MOST_PADDING {
                    self.strange("an object without its end", repairs);
                }
                self.buffer.clear();
                self.skip = 0;
            }
            Piece::Container => {}
        }
        let skipped = self.skip.min(self.piece.len());
        self.skip -= skipped;
        self.buffer.extend_from_slice(self.piece.get(skipped..).unwrap_or_default());
        Ok(true)
    }

    fn end(&mut self, repairs: &mut FrameRepairs) -> Result<Option<CanFrame>, CanProblem> {
        let left = self.buffer.len() - self.at;
        if left > MOST_PADDING || self.skip > 0 {
            repairs.cut_off.get_or_insert(FramePlace::Byte(self.containers.position));
        }
        match repairs.first_not_understood.as_ref() {
            Some(first) if !self.any_object => Err(CanProblem::NoObject {
                byte: match first.place {
                    FramePlace::Byte(at) | FramePlace::Line(at) | FramePlace::Frame(at) => at,
                },
                found: first.found.clone(),
            }),
            _ => Ok(None),
        }
    }

    fn strange(&self, found: &str, repairs: &mut FrameRepairs) {
        let place = FramePlace::Byte(self.containers.position);
        repairs.not_understood(place, format!("{found} before"), "an object that begins with LOBJ");
    }
}

impl FrameSource for BlfReader {
    fn next_frame(&mut self, repairs: &mut FrameRepairs) -> Result<Option<CanFrame>, CanProblem> {
        loop {
            match self.step() {
                Step::Frame(padding, size) => {
                    let begin = self.at + padding;
                    let object = object::parse(self.buffer.get(begin..begin + size).unwrap_or_default());
                    self.at = begin + size;
                    self.any_object = true;
                    match object {
                        Object::Frame(mut frame) => {
                            frame.time_s += self.start_s;
                            return Ok(Some(frame));
                        }
                        Object::Other => repairs.passed_over += 1,
                        Object::Broken => self.strange("an object shorter than its fields", repairs),
                    }
                }
                Step::Other(size) => {
                    self.any_object = true;
                    repairs.passed_over += 1;
                    self.pass(size);
                }
                Step::Stray(size) => {
                    self.strange("bytes of no object", repairs);
                    self.pass(size);
                }
                Step::More => {
                    if self.is_over || !self.refill(repairs).map_err(FileProblem::Read)? {
                        return self.end(repairs);
                    }
                }
            }
        }
    }

    fn progress(&self) -> f64 {
        self.containers.progress()
    }
}
