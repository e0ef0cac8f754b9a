//! The connection to the broker, made again whenever it breaks. Empties the outbox.

use std::time::Instant;

use rumqttc::{AsyncClient, Event, EventLoop, LastWill, Outgoing, Packet, QoS};
use tokio::time::{Duration, timeout};

use super::outbox::{Shared, status};
use crate::broker::{Backoff, BrokerAddress};
use crate::input::{Note, NoteSink};

/// Requests between outbox and connection.
const REQUESTS: usize = 64;
/// Longest time without a look whether everything is done.
const LOOK_EVERY: Duration = Duration::from_millis(100);

/// Runs until the outbox is closed and empty, or out of time.
pub(super) fn run(address: &BrokerAddress, shared: &Shared, notes: &NoteSink) {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    match runtime {
        Ok(runtime) => runtime.block_on(converse(address, shared, notes)),
        Err(error) => notes(Note::Warning(format!("MQTT: cannot start: {error}"))),
    }
}

async fn converse(address: &BrokerAddress, shared: &Shared, notes: &NoteSink) {
    let (mut options, network) = address.options("out");
    let will = status(&address.topic, "offline");
    options.set_last_will(LastWill::new(will.topic, will.payload, QoS::AtLeastOnce, true));
    let (client, mut events) = AsyncClient::new(options, REQUESTS);
    events.set_network_options(network);
    // Whichever ends first ends the other: the sender does when everything has arrived.
    tokio::select! {
        () = listen(&mut events, address, shared, notes) => {}
        () = send(&client, address, shared) => {}
    }
    // A word of farewell, so that the broker does not publish the last will.
    let _ = client.try_disconnect();
    let farewell = async { while events.poll().await.is_ok() {} };
    let _ = timeout(LOOK_EVERY, farewell).await;
}

/// Keeps the connection and takes acknowledgements; never ends.
async fn listen(events: &mut EventLoop, address: &BrokerAddress, shared: &Shared, notes: &NoteSink) {
    let place = address.place();
    let mut backoff = Backoff::default();
    let mut gone: Option<Instant> = None;
    loop {
        match events.poll().await {
            Ok(Event::Incoming(Packet::ConnAck(_))) => {
                backoff.connected();
                let mut outbox = shared.lock();
                let waiting = outbox.left();
                outbox.connected();
                drop(outbox);
                shared.changed.notify_one();
                if let Some(gone) = gone.take() {
                    let after_s = gone.elapsed().as_secs_f64();
                    let text =
                        format!("{place}: connected after {after_s:.1} s, {waiting} messages are sent now");
                    notes(Note::Remark(text));
                }
            }
            Ok(Event::Outgoing(Outgoing::Publish(number))) if number != 0 => shared.lock().numbered(number),
            Ok(Event::Incoming(Packet::PubAck(ack))) => {
                shared.lock().acknowledged(ack.pkid);
                shared.changed.notify_one();
            }
            Ok(_) => {}
            Err(error) => {
                // The outbox sends again what was not acknowledged; what the client kept would be sent twice or, to a
                // broker that has forgotten us, not at all.
                events.clean();
                events.pending.clear();
                let again = shared.lock().disconnected();
                if gone.is_none() {
                    gone = Some(Instant::now());
                    let text =
                        format!("{place}: {error}; trying again, {again} messages were not acknowledged");
                    notes(Note::Warning(text));
                }
                tokio::time::sleep(backoff.next()).await;
            }
        }
    }
}

/// Hands on what waits; ends when everything has arrived or the time is over.
async fn send(client: &AsyncClient, address: &BrokerAddress, shared: &Shared) {
    let estimates = format!("{}/estimate", address.topic);
    loop {
        let (message, newest, done) = {
            let mut outbox = shared.lock();
            (outbox.send(), outbox.send_newest(), outbox.is_done())
        };
        if done {
            return;
        }
        let idle = message.is_none();
        if let Some(message) = message {
            // Fails only when the connection's half is gone, and then this half ends, too.
            let _ = client.publish(message.topic, QoS::AtLeastOnce, true, message.payload).await;
        }
        if let Some(newest) = newest {
            let _ = client.try_publish(&estimates, QoS::AtMostOnce, false, newest);
        }
        if idle {
            let _ = timeout(LOOK_EVERY, shared.changed.notified()).await;
        }
    }
}
