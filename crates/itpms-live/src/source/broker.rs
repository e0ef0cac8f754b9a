//! Lines of `candump -L` as messages of an MQTT broker, one or more to a message.
//!
//! A message is acknowledged when its frames are in the queue. What the broker was sent while we were not connected is
//! lost: for that, the time of the next frame shows a gap.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use rumqttc::{AsyncClient, Event, Packet, QoS};
use tokio::time::timeout;

use super::lines::Lines;
use crate::broker::{Backoff, BrokerAddress};
use crate::input::{Input, NoteSink, SourceName};
use crate::queue::Queue;

/// Longest time without a look whether an end is wanted.
const LOOK_EVERY: Duration = Duration::from_millis(200);

pub fn name(address: &BrokerAddress) -> SourceName {
    SourceName { name: format!("{}:{}/{}", address.host, address.port, address.topic), kind: "mqtt" }
}

/// Starts to listen; a broker that is not there yet is waited for.
pub fn start(address: BrokerAddress, inputs: Arc<Queue<Input>>, stop: Arc<AtomicBool>, notes: NoteSink) {
    thread::spawn(move || {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
        match runtime {
            Ok(runtime) => runtime.block_on(listen(&address, &inputs, &stop, notes)),
            Err(error) => {
                inputs.push(Input::Failed(format!("MQTT: cannot start: {error}")));
            }
        }
        inputs.close();
    });
}

async fn listen(address: &BrokerAddress, inputs: &Queue<Input>, stop: &AtomicBool, notes: NoteSink) {
    let (mut options, network) = address.options("in");
    options.set_manual_acks(true);
    let (client, mut events) = AsyncClient::new(options, 64);
    events.set_network_options(network);
    let mut lines = Lines::new(&name(address).name, notes);
    let mut backoff = Backoff::default();
    let mut lost = false;
    while !stop.load(Ordering::Relaxed) {
        let mut poll = std::pin::pin!(events.poll());
        let event = loop {
            match timeout(LOOK_EVERY, poll.as_mut()).await {
                Ok(event) => break event,
                Err(_) if stop.load(Ordering::Relaxed) => return,
                Err(_) => {}
            }
        };
        match event {
            Ok(Event::Incoming(Packet::ConnAck(_))) => {
                backoff.connected();
                let _ = client.try_subscribe(&address.topic, QoS::AtLeastOnce);
                if std::mem::take(&mut lost) {
                    inputs.push(Input::Reconnected);
                }
            }
            Ok(Event::Incoming(Packet::Publish(message))) => {
                let arrived = Instant::now();
                let texts = message.payload.split(|byte| *byte == b'\n');
                let found: Vec<Input> = texts.filter_map(|line| lines.take(line, arrived)).collect();
                if !inputs.push_all(found) {
                    return;
                }
                let _ = client.try_ack(&message);
            }
            Ok(_) => {}
            Err(error) => {
                if !std::mem::replace(&mut lost, true) {
                    inputs.push(Input::Disconnected(error.to_string()));
                }
                tokio::time::sleep(backoff.next()).await;
            }
        }
    }
}
