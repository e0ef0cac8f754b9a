//! MDF4 to MDF4: every channel that holds numbers and has a time, group after group.

use super::{Converted, LOOK, Look, Request, counted};
use crate::error::DataError;
use crate::mdf4::{ChannelGroup, ChannelKind, ChannelSpec, GroupSpec, Mdf4Reader, Mdf4Writer, SampleFormat};

pub(super) fn convert(request: &Request<'_>, look: Look<'_>) -> Result<Option<Converted>, DataError> {
    let reader = Mdf4Reader::open(request.input)?;
    let mut warnings: Vec<String> = reader.repairs().iter().map(ToString::to_string).collect();
    let mut kept = Vec::new();
    for (index, group) in reader.groups().iter().enumerate() {
        let channels = numbers(group);
        let others = group.channels.iter().filter(|channel| !channel.is_time).count() - channels.len();
        if !group.has_time {
            warnings.push(format!("group {} has no time and was left out", group.name));
        } else if others > 0 {
            let others = counted(others as u64, "channel");
            warnings.push(format!("{others} of group {} hold no numbers: left out", group.name));
        }
        if group.has_time && !channels.is_empty() {
            kept.push((index, channels));
        }
    }
    let specs: Vec<GroupSpec> =
        kept.iter().map(|(index, channels)| spec(&reader.groups()[*index], channels)).collect();
    let mut writer = Mdf4Writer::create(request.output, &specs, request.packing.into())?;
    writer.set_start_ns(reader.start_ns());
    let (mut count, mut timeless) = (0u64, 0u64);
    for (place, (index, channels)) in kept.iter().enumerate() {
        let mut cursor = reader.cursor(*index, channels)?;
        let mut values = vec![f64::NAN; channels.len()];
        while let Some(time_s) = cursor.next(&mut values)? {
            if count.is_multiple_of(LOOK)
                && look((place as f64 + cursor.progress()) / kept.len() as f64).is_break()
            {
                return Ok(None);
            }
            count += 1;
            if time_s.is_finite() {
                writer.write(place, time_s, &values)?;
            } else {
                timeless += 1;
            }
        }
        warnings.extend(cursor.repairs().iter().map(ToString::to_string));
    }
    if timeless > 0 {
        warnings.push(format!("{} without a time: left out", counted(timeless, "sample")));
    }
    let content =
        format!("{} in {}", counted(count - timeless, "sample"), counted(kept.len() as u64, "channel group"));
    Ok(Some(Converted { file: writer.finish()?, content, warnings, remarks: Vec::new() }))
}

fn numbers(group: &ChannelGroup) -> Vec<usize> {
    let number = |index: &usize| {
        let channel = &group.channels[*index];
        !channel.is_time && channel.kind == ChannelKind::Number
    };
    (0..group.channels.len()).filter(number).collect()
}

fn spec(group: &ChannelGroup, channels: &[usize]) -> GroupSpec {
    let channels = channels.iter().map(|index| &group.channels[*index]).map(|channel| ChannelSpec {
        name: channel.name.clone(),
        unit: channel.unit.clone(),
        comment: channel.comment.clone(),
        format: SampleFormat::Float64,
    });
    GroupSpec { name: group.name.clone(), comment: String::new(), channels: channels.collect() }
}
