//! Tables of frames as comma-separated values: SavvyCAN's (GVRET), python-can's and that of openpilot's cabana. Called through the reader of lines; the first line says which it is.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::digits::{self, Base};
use super::frame::{CanFrame, CanId, Direction, FrameKind, Payload};
use super::line_format::{LineContent, LineFormat};

const EXPECTED_ID: &str = "a hexadecimal identifier of 11 or 29 bits";
const EXPECTED_DATA: &str = "a length and as many bytes";

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum FrameTable {
    /// `timestamp,arbitration_id,extended,remote,error,dlc,data`: seconds, data in base64.
    PythonCan,
    /// `Time Stamp,ID,Extended,Dir,Bus,LEN,D1,...`: microseconds, a byte per cell. The place of each column; older ones have no `Dir`.
    SavvyCan { columns: [Option<usize>; 6], data: usize },
    /// `time,addr,bus,data`: seconds, data in hexadecimal; the address, too, where it begins with `0x`, else in decimal.
    Cabana,
}

/// SavvyCAN's columns, in capitals.
const SAVVY_CAN: [&str; 6] = ["TIME STAMP", "ID", "EXTENDED", "DIR", "BUS", "LEN"];

impl FrameTable {
    /// The table that begins with this line; `None` if it is one of something else.
    pub(super) fn of_header(line: &[u8]) -> Option<Self> {
        let line = std::str::from_utf8(line.trim_ascii()).ok()?.trim_start_matches('\u{feff}').to_uppercase();
        let names: Vec<&str> = line.split(',').map(str::trim).collect();
        if line == "TIMESTAMP,ARBITRATION_ID,EXTENDED,REMOTE,ERROR,DLC,DATA" {
            return Some(Self::PythonCan);
        }
        if names == ["TIME", "ADDR", "BUS", "DATA"] {
            return Some(Self::Cabana);
        }
        let place = |name: &str| names.iter().position(|other| *other == name);
        let columns = SAVVY_CAN.map(place);
        let needed = [0, 1, 5].iter().all(|column| columns[*column].is_some());
        Some(Self::SavvyCan { columns, data: place("D1").filter(|_| needed)? })
    }
}

impl LineFormat for FrameTable {
    const EXPECTED: &'static str =
        "a line of a table of frames such as 166064000,0000021A,false,Rx,0,8,FE,36,12,FE,69,05,07,AD";

    fn line(&mut self, text: &[u8]) -> Result<LineContent, &'static str> {
        let text = text.trim_ascii();
        let is_header = text.first().is_some_and(u8::is_ascii_alphabetic) && Self::of_header(text).is_some();
        if text.is_empty() || is_header {
            return Ok(LineContent::Nothing);
        }
        let cells = || text.split(|byte| *byte == b',').map(<[u8]>::trim_ascii);
        match self {
            Self::PythonCan => python_can(cells()),
            Self::SavvyCan { columns, data } => savvy_can(cells, columns, *data),
            Self::Cabana => cabana(cells()),
        }
        .map(LineContent::Frame)
    }
}

fn python_can<'a>(mut cells: impl Iterator<Item = &'a [u8]>) -> Result<CanFrame, &'static str> {
    let mut next = || cells.next().ok_or(FrameTable::EXPECTED);
    let time_s = digits::seconds(next()?).ok_or("seconds")?;
    let id = next()?;
    let id = id.strip_prefix(b"0x").unwrap_or(id);
    let mut is_set = || next().map(|cell| cell == b"1");
    let (is_extended, is_remote, is_error) = (is_set()?, is_set()?, is_set()?);
    let id = identifier(id, is_extended)?;
    let length =
        digits::unsigned(next()?, Base::Decimal).filter(|length| *length <= 64).ok_or(EXPECTED_DATA)?;
    let mut bytes = [0; 66];
    let text = next()?;
    let found = STANDARD.decode_slice(text, &mut bytes).map_err(|_| "data of up to 64 bytes in base64")?;
    let data =
        bytes.get(..found).filter(|data| is_remote || data.len() == length as usize).ok_or(EXPECTED_DATA)?;
    let payload = if is_remote { Payload::zeros(length as usize) } else { Payload::new(data) };
    let kind = match (is_error, is_remote) {
        (true, _) => FrameKind::Error,
        (_, true) => FrameKind::Remote,
        _ => data_of(length as usize),
    };
    let payload = payload.ok_or(EXPECTED_DATA)?;
    Ok(CanFrame { time_s, bus: 0, id, kind, direction: Direction::Rx, payload })
}

fn savvy_can<'a, I: Iterator<Item = &'a [u8]>>(
    cells: impl Fn() -> I,
    columns: &[Option<usize>; 6],
    data: usize,
) -> Result<CanFrame, &'static str> {
    let cell = |column: usize| columns[column].and_then(|place| cells().nth(place)).unwrap_or_default();
    let time_s = digits::seconds(cell(0)).ok_or("microseconds")? / 1e6;
    let id = identifier(cell(1), cell(2).eq_ignore_ascii_case(b"true") || cell(2) == b"1")?;
    let direction = if cell(3).eq_ignore_ascii_case(b"tx") { Direction::Tx } else { Direction::Rx };
    let bus = if columns[4].is_some() { digits::unsigned(cell(4), Base::Decimal) } else { Some(0) };
    let bus = bus.and_then(|bus| u16::try_from(bus).ok()).ok_or("a bus from 0 to 65535")?;
    let length =
        digits::unsigned(cell(5), Base::Decimal).filter(|length| *length <= 64).ok_or(EXPECTED_DATA)?;
    let mut payload = Payload::EMPTY;
    for byte in cells().skip(data).take(length as usize) {
        let byte = digits::unsigned(byte, Base::Hexadecimal).and_then(|byte| u8::try_from(byte).ok());
        if !payload.push(byte.ok_or(EXPECTED_DATA)?) {
            return Err(EXPECTED_DATA);
        }
    }
    if payload.len() != length as usize {
        return Err(EXPECTED_DATA);
    }
    Ok(CanFrame { time_s, bus, id, kind: data_of(payload.len()), direction, payload })
}

fn cabana<'a>(mut cells: impl Iterator<Item = &'a [u8]>) -> Result<CanFrame, &'static str> {
    let mut next = || cells.next().ok_or("a line of cabana such as 0.25,0x1A0,0,0xFE3612");
    let time_s = digits::seconds(next()?).ok_or("seconds")?;
    let (address, base) = match next()? {
        [b'0', b'x' | b'X', address @ ..] => (address, Base::Hexadecimal),
        address => (address, Base::Decimal),
    };
    let number = digits::unsigned(address, base).ok_or("an address such as 0x1A0, or 416 in decimal")?;
    let id = CanId::standard(number).or(CanId::extended(number)).ok_or(EXPECTED_ID)?;
    let bus = digits::unsigned(next()?, Base::Decimal).and_then(|bus| u16::try_from(bus).ok());
    let bus = bus.ok_or("a bus from 0 to 65535")?;
    let data = next()?;
    let data = data.strip_prefix(b"0x").unwrap_or(data);
    let mut payload = Payload::EMPTY;
    for pair in data.chunks(2) {
        let byte = digits::byte(pair).ok_or("data of up to 64 bytes in pairs of hexadecimal digits")?;
        if !payload.push(byte) {
            return Err(EXPECTED_DATA);
        }
    }
    Ok(CanFrame { time_s, bus, id, kind: data_of(payload.len()), direction: Direction::Rx, payload })
}

/// No table says whether a data frame is one of CAN FD: more than eight bytes are.
fn data_of(length: usize) -> FrameKind {
    if length > 8 {
        FrameKind::Fd { bit_rate_switch: false, error_state_indicator: false }
    } else {
        FrameKind::Data
    }
}

fn identifier(text: &[u8], is_extended: bool) -> Result<CanId, &'static str> {
    let number = digits::unsigned(text, Base::Hexadecimal).ok_or(EXPECTED_ID)?;
    let id = if is_extended { CanId::extended(number) } else { CanId::standard(number) };
    id.ok_or(EXPECTED_ID)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(header: &str, line: &str) -> Result<CanFrame, &'static str> {
        match FrameTable::of_header(header.as_bytes()).unwrap().line(line.as_bytes())? {
            LineContent::Frame(frame) => Ok(frame),
            other => panic!("{other:?}"),
        }
    }

    const NEW: &str = "Time Stamp,ID,Extended,Dir,Bus,LEN,D1,D2,D3,D4,D5,D6,D7,D8";
    const OLD: &str = "Time Stamp,ID,Extended,Bus,LEN,D1,D2,D3,D4,D5,D6,D7,D8";
    const PYTHON: &str = "timestamp,arbitration_id,extended,remote,error,dlc,data";

    #[test]
    fn savvycans_tables_are_read_old_and_new() {
        let new = frame(NEW, "166064000,0000021A,false,Tx,2,8,FE,36,12,FE,69,05,07,AD,").unwrap();
        assert_eq!((new.time_s, new.bus, new.direction), (166.064, 2, Direction::Tx));
        assert_eq!(new.data(), [0xFE, 0x36, 0x12, 0xFE, 0x69, 0x05, 0x07, 0xAD]);
        let old = frame(OLD, "1426535529000100,18FEF100,true,0,2,0A,FF").unwrap();
        assert_eq!((old.id, old.data()), (CanId::extended(0x18FE_F100).unwrap(), &[0x0A, 0xFF][..]));
        assert_eq!(old.time_s, 1_426_535_529.000_1);
        for line in [
            "1,21A,false,Rx,0,2,FE",
            "1,800,false,Rx,0,0",
            "x,1,false,Rx,0,0",
            "1,1,false,Rx,0,65,00",
            "1,1,false,Rx,0,1,100",
        ] {
            assert!(frame(NEW, line).is_err(), "{line}");
        }
    }

    #[test]
    fn python_cans_table_is_read() {
        let found = frame(PYTHON, "1483389946.197,0xdadada,1,0,0,6,WzQyLCA5").unwrap();
        assert_eq!((found.time_s, found.id), (1_483_389_946.197, CanId::extended(0x00DA_DADA).unwrap()));
        assert_eq!(found.data(), b"[42, 9");
        assert_eq!(frame(PYTHON, "1.5,0x12,0,1,0,3,").unwrap().kind, FrameKind::Remote);
        assert!(frame(PYTHON, "1.5,0x12,0,0,0,3,").is_err());
        assert!(frame(PYTHON, "1.5,0x12,0,0,0,3,!!!!").is_err());
        assert!(frame(PYTHON, "1.5,0x12,0").is_err());
    }

    #[test]
    fn cabanas_table_is_read_in_both_styles() {
        const CABANA: &str = "time,addr,bus,data";
        let new = frame(CABANA, "0.2500,0x110,2,0x0300070000000000").unwrap();
        assert_eq!((new.time_s, new.bus, new.id), (0.25, 2, CanId::standard(0x110).unwrap()));
        assert_eq!(new.data(), [3, 0, 7, 0, 0, 0, 0, 0]);
        let old = frame(CABANA, "0.2500,272,2,0300070000000000").unwrap();
        assert_eq!(old, new);
        assert_eq!(frame(CABANA, "1,0x18FEF100,0,0x").unwrap().id, CanId::extended(0x18FE_F100).unwrap());
        for line in ["1,0x20000000,0,00", "1,1A0,0,00", "1,0x1A0,0,0x0", "1,0x1A0,0", "x,1,0,00"] {
            assert!(frame(CABANA, line).is_err(), "{line}");
        }
    }

    #[test]
    fn other_tables_are_none_of_frames() {
        for header in ["time_s,speed_m_s", "Time Stamp,ID,LEN", "", "ID,D1,LEN"] {
            assert_eq!(FrameTable::of_header(header.as_bytes()), None, "{header}");
        }
    }
}
