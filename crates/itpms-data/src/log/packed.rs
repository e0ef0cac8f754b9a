//! The bytes behind gzip, as far as there are whole ones.
//!
//! Called by the lines of text tables. A file whose end is missing ends with its last byte that can be unpacked, zeros after its end are
//! padding, and one that unpacks without an end is refused.

use std::fs::File;
use std::io::{self, BufRead, BufReader, ErrorKind, Read, Seek};

use flate2::bufread::GzDecoder;

/// How gzip begins, whatever the file is called.
pub(super) const GZIP: &[u8] = &[0x1f, 0x8b];
/// What may come out of a file, in bytes, and besides for each of its bytes: rows of numbers shrink to a third or a tenth, those of
/// a car that stands to a thirtieth.
const FREE: u64 = 1 << 28;
const PER_BYTE: u64 = 100;

#[derive(Debug)]
pub(super) struct Packed {
    /// `None` behind the end.
    member: Option<GzDecoder<BufReader<File>>>,
    unpacked: u64,
    pub(super) is_cut_off: bool,
}

impl Packed {
    pub(super) fn new(file: BufReader<File>) -> Self {
        Self { member: Some(GzDecoder::new(file)), unpacked: 0, is_cut_off: false }
    }

    /// After a member another one may follow; zeros are what fills the last block of a tape or a disk.
    fn next_member(&mut self) -> io::Result<()> {
        let Some(member) = self.member.take() else { return Ok(()) };
        let mut file = member.into_inner();
        loop {
            let ahead = file.fill_buf()?;
            let zeros = ahead.iter().take_while(|byte| **byte == 0).count();
            match ahead.get(zeros..) {
                None | Some([]) if zeros == 0 => return Ok(()),
                Some([0x1f, ..]) => {
                    file.consume(zeros);
                    self.member = Some(GzDecoder::new(file));
                    return Ok(());
                }
                Some([_, ..]) => {
                    let what = "something else than gzip follows behind the end of the packed data, expected nothing";
                    return Err(io::Error::new(ErrorKind::InvalidData, what));
                }
                _ => file.consume(zeros),
            }
        }
    }
}

/// Refuses what unpacks without an end.
fn bound(unpacked: u64, file: &mut File) -> io::Result<()> {
    if unpacked <= FREE {
        return Ok(());
    }
    // A pipe has no place; what comes through it is as long as it is.
    let Ok(packed) = file.stream_position() else { return Ok(()) };
    let most = FREE.saturating_add(packed.saturating_mul(PER_BYTE));
    if unpacked <= most {
        return Ok(());
    }
    let text = format!(
        "{packed} bytes unpack to more than {most}, the most that is read of them (256 MiB, and a hundred for each): no log is packed like that; if it is one, unpack it (gunzip) and read that"
    );
    Err(io::Error::new(ErrorKind::InvalidData, text))
}

impl Read for Packed {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        while let Some(member) = &mut self.member {
            match member.read(bytes) {
                Ok(0) if !bytes.is_empty() => self.next_member()?,
                Ok(read) => {
                    self.unpacked += read as u64;
                    bound(self.unpacked, member.get_mut().get_mut())?;
                    return Ok(read);
                }
                Err(error) if error.kind() == ErrorKind::UnexpectedEof => {
                    self.is_cut_off = true;
                    self.member = None;
                }
                Err(error) => return Err(error),
            }
        }
        Ok(0)
    }
}
