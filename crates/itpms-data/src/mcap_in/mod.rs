//! MCAP in: the numbers in the messages of every topic, in JSON, ROS 1, ROS 2 (CDR) or protobuf, by the schemas that the file carries.
//!
//! | module | idea |
//! |---|---|
//! | `records` | the file's records, one after the other, in bounded memory |
//! | `fields` | a message as paths and numbers: `linear_acceleration.z` |
//! | `json`, `ros`, `protobuf` | what the bytes of a message are |
//! | `topics` | what is in a file: topics and their signals |
//!
//! Called by the reader of drive logs and by the list of signals, so that both know the same. What is written is in
//! [`out::mcap`](crate::out::mcap); the records of both are the crate `mcap`'s.

mod fields;
mod json;
mod protobuf;
mod records;
mod ros;
mod topics;

pub(crate) use records::Messages;
pub(crate) use topics::Topics;
