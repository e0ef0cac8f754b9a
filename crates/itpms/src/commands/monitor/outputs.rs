//! The outputs that were asked for.

use std::path::Path;
use std::sync::Arc;

use itpms_console::{Failure, Screen};
use itpms_live::http::{self, Server};
use itpms_live::hub::Hub;
use itpms_live::input::NoteSink;
#[cfg(feature = "mcap")]
use itpms_live::output::McapOut;
use itpms_live::output::can::CanOut;
use itpms_live::output::{JsonLines, Mqtt, Output, WhenSlow};

use super::{access, failure};
use crate::args::MonitorArgs;

/// Starts everything that takes estimates, but for the page. `source_waits`: a source that waits may be held up by a slow
/// pipe; a bus may not.
pub(super) fn open(
    args: &MonitorArgs,
    source_waits: bool,
    notes: &NoteSink,
    screen: &Screen,
) -> Result<Vec<Output>, Failure> {
    let mut outputs = Vec::new();
    #[cfg(feature = "mcap")]
    if let Some(path) = &args.mcap {
        let recording = McapOut::open(path).map_err(failure)?;
        if recording.path() != path {
            let (there, new) = (path.display(), recording.path().display());
            screen.remark(format!("{there}: is there already; the recording goes to {new}"));
        }
        outputs.push(recording.start());
    }
    let none = outputs.is_empty() && args.can_out.is_none() && args.mqtt.is_none() && args.http.is_none();
    let standard = none.then(|| Path::new("-"));
    if let Some(path) = args.json.as_deref().or(standard) {
        let is_file = path != Path::new("-");
        let when_slow = if is_file || source_waits { WhenSlow::Wait } else { WhenSlow::LoseEstimates };
        outputs.push(JsonLines::open(path).map_err(failure)?.start(when_slow));
    }
    if let Some(target) = &args.can_out {
        outputs.push(CanOut::open(target, notes).map_err(failure)?.start());
    }
    if let Some(address) = &args.mqtt {
        let address = access::broker(args, address, screen)?;
        outputs.push(Mqtt::open(address, notes).map_err(failure)?.start());
    }
    Ok(outputs)
}

pub(super) fn serve(args: &MonitorArgs, hub: &Arc<Hub>, screen: &Screen) -> Result<Option<Server>, Failure> {
    let Some(address) = args.http else { return Ok(None) };
    let options = http::Options {
        address,
        hosts: args.http_allow_host.clone(),
        origins: args.http_allow_origin.clone(),
        pressure_unit: args.unit.pressure_unit,
    };
    let server = Server::start(options, Arc::clone(hub));
    let server = server.map_err(|error| Failure::Usage(error.to_string()))?;
    screen.remark(format!("the page is at http://{}/", server.address()));
    if server.is_open_to_others() {
        screen.warn("the page has NO PASSWORD and is OPEN TO EVERYONE who reaches this machine; 127.0.0.1 keeps it here");
    }
    Ok(Some(server))
}
