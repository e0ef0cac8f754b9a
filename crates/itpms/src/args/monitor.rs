//! Arguments of `itpms monitor`.

use std::net::SocketAddr;
use std::path::PathBuf;

use clap::ArgGroup;
use itpms_core::warning::Regulation;
use itpms_live::source::Speed;

use super::{LogArgs, UnitArgs, VEHICLE, one_of, positive};

/// Watch a car live: estimates and warnings from a CAN bus, a broker or a replayed log, as they come.
///
/// Ends with the log or the input, or with Ctrl-C or SIGTERM (then, too, with exit code 0). Whatever takes the estimates
/// never delays them.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
#[command(group(ArgGroup::new("source").required(true).args(["interface", "replay", "mqtt_in", "print_dbc"])))]
pub(crate) struct MonitorArgs {
    /// A SocketCAN interface such as can0, or - for lines of candump on standard input.
    pub(crate) interface: Option<String>,
    /// Masses, springs, dampers and tires of the corners.
    #[arg(long, value_name = "V.toml", env = VEHICLE, hide_env_values = true, required_unless_present = "print_dbc")]
    pub(crate) vehicle: Option<PathBuf>,
    /// A log instead of a bus: a drive log, or a CAN log with --dbc.
    #[arg(long, value_name = "LOG")]
    pub(crate) replay: Option<PathBuf>,
    /// The tooth pulses of the four wheel speed sensors by the log's clock, time_s and wheel: .csv or .parquet. They count together
    /// with its wheel speeds, as in `itpms estimate`.
    #[arg(long, value_name = "PULSES")]
    pub(crate) pulses: Option<PathBuf>,
    /// How fast a log is replayed: N times as fast as it was recorded, or max.
    #[arg(long, value_name = "N|max", default_value = "1", value_parser = speed, requires = "replay")]
    pub(crate) speed: Speed,
    /// Lines of candump -L as messages of an MQTT broker.
    #[arg(long, value_name = "mqtt[s]://[USER@]HOST[:PORT]/TOPIC")]
    pub(crate) mqtt_in: Option<String>,
    #[command(flatten)]
    pub(crate) unit: UnitArgs,
    #[command(flatten)]
    pub(crate) reading: LogArgs,
    /// Where lines of JSON go, estimates and warnings: a file, which grows, or - for standard output. Standard output
    /// unless any output is given.
    #[arg(long, value_name = "FILE|-")]
    pub(crate) json: Option<PathBuf>,
    /// Where a recording for Foxglove and PlotJuggler goes: .mcap. One that is there stays: the new one is then NAME-2.mcap and so on.
    #[cfg(feature = "mcap")]
    #[arg(long, value_name = "MCAP")]
    pub(crate) mcap: Option<PathBuf>,
    /// Where CAN frames of our own DBC go: an interface or a file of candump lines.
    #[arg(long, value_name = "IFACE|FILE")]
    pub(crate) can_out: Option<String>,
    /// Where PREFIX/estimate, PREFIX/warning and PREFIX/status go.
    #[arg(long, value_name = "mqtt[s]://[USER@]HOST[:PORT]/PREFIX")]
    pub(crate) mqtt: Option<String>,
    /// The password of the broker's user, the first line of a file; without it, the variable ITPMS_MQTT_PASSWORD is asked.
    #[arg(long, value_name = "FILE")]
    pub(crate) mqtt_password_file: Option<PathBuf>,
    /// Whom to believe that it is the broker, certificates in PEM; those whom the system believes unless given.
    #[arg(long, value_name = "CA.pem")]
    pub(crate) mqtt_ca: Option<PathBuf>,
    /// Where the page is served, such as 127.0.0.1:8080; a port alone is one of this machine only.
    #[arg(long, value_name = "ADDR", value_parser = address)]
    pub(crate) http: Option<SocketAddr>,
    /// A name under which the page may be asked for besides addresses, names without a dot and *.local; may be repeated.
    #[arg(long, value_name = "NAME", requires = "http")]
    pub(crate) http_allow_host: Vec<String>,
    /// An origin such as `https://fleet.example.com` whose pages may read the stream; may be repeated.
    #[arg(long, value_name = "ORIGIN", requires = "http")]
    pub(crate) http_allow_origin: Vec<String>,
    /// What is known of the car, kept from one start to the next: saved every minute and at the end.
    #[arg(long, value_name = "FILE")]
    pub(crate) state: Option<PathBuf>,
    /// Estimates per second.
    #[arg(long, value_name = "HZ", default_value_t = 10.0, value_parser = positive)]
    pub(crate) rate: f64,
    /// The first S seconds are driven at placard pressure: a calibration. Not where a saved state goes on.
    #[arg(long, value_name = "S", value_parser = positive)]
    pub(crate) calibrate_s: Option<f64>,
    /// What a calibration taught of this car on an earlier drive.
    #[arg(long, value_name = "FILE", conflicts_with = "calibrate_s")]
    pub(crate) reference: Option<PathBuf>,
    /// Which loss is warned of, as in `itpms estimate`.
    #[arg(long, value_name = "NAME", default_value = Regulation::default().label(), value_parser = one_of(Regulation::ALL, Regulation::label))]
    pub(crate) regulation: Regulation,
    /// Print the DBC of the frames of --can-out, and nothing else.
    #[arg(long)]
    pub(crate) print_dbc: bool,
}

const EXAMPLES: &str = "\
Examples:
  itpms monitor can0 --vehicle car.toml --dbc car.dbc --http 127.0.0.1:8080
  candump -L can0 | itpms monitor - --vehicle car.toml --dbc car.dbc
  itpms monitor --replay drive.csv --speed 10 --vehicle car.toml --json live.jsonl
  itpms monitor can0 --vehicle car.toml --dbc car.dbc --mcap live.mcap
  itpms monitor can0 --vehicle car.toml --dbc car.dbc --mqtt mqtt://127.0.0.1:1883/car7 --state car7.state
  itpms monitor can0 --vehicle car.toml --dbc car.dbc --mqtt mqtts://car7@broker.example.com/fleet/car7
  itpms monitor --print-dbc > itpms.dbc";

fn speed(text: &str) -> Result<Speed, String> {
    match text {
        "max" => Ok(Speed::Max),
        times => positive(times).map(Speed::Times).map_err(|error| format!("{error}, or max")),
    }
}

fn address(text: &str) -> Result<SocketAddr, String> {
    if let Ok(port) = text.trim_start_matches(':').parse::<u16>() {
        return Ok(SocketAddr::from(([127, 0, 0, 1], port)));
    }
    text.parse().map_err(|_| "expected an address and a port, such as 127.0.0.1:8080".to_owned())
}
