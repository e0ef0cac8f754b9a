//! The outputs that were asked for.

use std::path::Path;
use std::sync::Arc;

use itpms_live::http::{self, Server};
use itpms_live::hub::Hub;
use itpms_live::input::Say;
use itpms_live::output::{JsonLines, Output, WhenSlow};

use super::failure;
use crate::args::MonitorArgs;
use crate::exit::Failure;
use crate::screen::Screen;

/// Starts everything that takes estimates, but for the page. `source_waits`: a source that waits may be held up by a slow
/// pipe; a bus may not.
pub(super) fn open(args: &MonitorArgs, source_waits: bool, _say: &Say) -> Result<Vec<Output>, Failure> {
    let mut outputs = Vec::new();
    let none = args.can_out.is_none() && args.mqtt.is_none() && args.http.is_none();
    let standard = none.then(|| Path::new("-"));
    if let Some(path) = args.json.as_deref().or(standard) {
        let is_file = path != Path::new("-");
        let when_slow = if is_file || source_waits { WhenSlow::Wait } else { WhenSlow::LoseEstimates };
        outputs.push(JsonLines::open(path).map_err(failure)?.start(when_slow));
    }
    Ok(outputs)
}

/// Starts the page.
pub(super) fn serve(args: &MonitorArgs, hub: &Arc<Hub>, screen: &Screen) -> Result<Option<Server>, Failure> {
    let Some(address) = args.http else { return Ok(None) };
    let server = Server::start(http::Options::new(address), Arc::clone(hub));
    let server = server.map_err(|error| Failure::Usage(error.to_string()))?;
    screen.remark(format!("the page is at http://{}/", server.address()));
    Ok(Some(server))
}

pub(super) fn print_dbc(_screen: &Screen) -> Result<(), Failure> {
    Ok(())
}
