//! Decodes and encodes messages of a DBC file, a line at a time, for whoever wants to compare.
//!
//! ```text
//! $ cargo run -p itpms-can-log --example dbc_lines -- examples/can/car.dbc
//! d 120 1F40000000000000            decode: identifier (8 digits if it has 29 bits), data
//! VehicleSpeed=80 YawRate=0 LateralAcc=0 ESP_Counter=0
//! e 120 80 0 0 3                    encode: identifier, a value per signal in the file's order
//! 1F40000000000003
//! ```

use std::error::Error;
use std::io::{self, BufRead as _, Write as _};
use std::path::Path;

use itpms_can_log::CanId;
use itpms_can_log::dbc::Dbc;

fn main() -> Result<(), Box<dyn Error>> {
    let name = std::env::args().nth(1).ok_or("expected the name of a DBC file")?;
    let dbc = Dbc::read(Path::new(&name))?;
    for problem in dbc.problems() {
        eprintln!("{name}: {problem}");
    }
    let mut out = io::stdout().lock();
    for line in io::stdin().lock().lines() {
        writeln!(out, "{}", answer(&dbc, &line?).unwrap_or_else(|problem| format!("error: {problem}")))?;
    }
    Ok(())
}

fn answer(dbc: &Dbc, line: &str) -> Result<String, Box<dyn Error>> {
    let mut words = line.split_whitespace();
    let what = words.next().ok_or("expected d or e")?;
    let id = words.next().ok_or("expected an identifier")?;
    let number = u32::from_str_radix(id, 16)?;
    let id = if id.len() > 3 { CanId::extended(number) } else { CanId::standard(number) };
    let message = id.and_then(|id| dbc.message(id)).ok_or("no such message")?;
    if what == "d" {
        let data = bytes(words.next().unwrap_or_default())?;
        let mut values = Vec::new();
        message
            .decode(&data, |place, value| values.push(format!("{}={value:?}", message.signals[place].name)));
        return Ok(values.join(" "));
    }
    let values = words.map(str::parse).collect::<Result<Vec<f64>, _>>()?;
    let payload = message.encode(|place| values.get(place).copied().unwrap_or(0.0))?;
    Ok(payload.as_slice().iter().map(|byte| format!("{byte:02X}")).collect())
}

fn bytes(hex: &str) -> Result<Vec<u8>, Box<dyn Error>> {
    if !hex.is_ascii() || !hex.len().is_multiple_of(2) {
        return Err("expected an even number of hexadecimal digits".into());
    }
    (0..hex.len()).step_by(2).map(|at| Ok(u8::from_str_radix(&hex[at..at + 2], 16)?)).collect()
}
