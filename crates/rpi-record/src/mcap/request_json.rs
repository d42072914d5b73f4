//! Encodes requests as JSON and decodes them.
//!
//! Example: `{"ticket":7,"ask":"start","command":4294967297}`. Commands and rules are written as numbers. The 64-bit
//! words of values and rules are written as hexadecimal strings, because JSON readers keep only 53 bits of a number.

use std::sync::Arc;

use rpi_core::{Command, CommandId, Continuity, MotionControls, Rule, RuleId};
use rpi_device::DeviceBank;
use rpi_image::Image;
use serde_json::{Value, json};

use super::event_json::{reason_from_keyword, reason_keyword};
use super::names::NameTable;
use super::recorder::{policy_from_keyword, policy_keyword};
use rpi_runtime::control::{InputValue, Request, RequestRecord, Subscription, Ticket};

/// Encodes a request to the core as a JSON object, with its ticket and the names of its commands.
pub(super) fn encode_request(ticket: Ticket, request: &RequestRecord, names: &NameTable) -> Value {
    let about = |ask: &str, id: &CommandId| json!({ "ask": ask, "command": id.to_number(), "name": names.command_name(*id) });
    let mut object = match request {
        RequestRecord::Load(id, _, continuity, on_overrun) => {
            let mut object = about("load", id);
            object["image"] = json!(names.image_index(*id));
            object["on_jump"] = json!(policy_keyword(*continuity));
            object["on_overrun"] = json!(on_overrun.to_string());
            object
        }
        RequestRecord::Start(id) => about("start", id),
        RequestRecord::Unschedule(id) => about("unschedule", id),
        RequestRecord::Cancel(id) => about("cancel", id),
        RequestRecord::Abort(id, why) => {
            let mut object = about("abort", id);
            object["why"] = json!(reason_keyword(*why));
            object
        }
        RequestRecord::Unload(id) => about("unload", id),
        RequestRecord::Schedule(rule, made) => {
            json!({ "ask": "schedule", "rule": rule.0, "words": encode_words(&made.to_words()) })
        }
        RequestRecord::Withdraw(rule) => json!({ "ask": "withdraw", "rule": rule.0 }),
        RequestRecord::Set(settings) => {
            json!({ "ask": "set", "settings": settings.iter().map(encode_setting).collect::<Vec<_>>() })
        }
        RequestRecord::Subscribe(id, exports, every) => {
            let mut object = about("subscribe", id);
            (object["exports"], object["every"]) = (json!(exports), json!(every));
            object
        }
        RequestRecord::Device(place) => json!({ "ask": "device", "place": place }),
        RequestRecord::SetControls(controls) => json!({
            "ask": "set-controls",
            "override": encode_words(&[controls.speed_override.to_bits()]),
            "paused": controls.paused,
        }),
        RequestRecord::MakeSafe(resources) => json!({ "ask": "make-safe", "resources": resources }),
        RequestRecord::EmergencyStop => json!({ "ask": "emergency-stop" }),
    };
    object["ticket"] = json!(ticket.0);
    object
}

fn encode_setting(setting: &InputValue) -> Value {
    let (command, input) = (setting.command.to_number(), setting.input);
    json!({ "command": command, "input": input, "value": encode_words(&setting.value) })
}

fn encode_words(words: &[u64]) -> Vec<String> {
    words.iter().map(|word| format!("{word:x}")).collect()
}

/// Decoder of recorded requests to requests that the core of a replay can carry out.
pub(super) struct RequestDecoder<'a> {
    /// Images in the recording, indexed by their numbers.
    pub(super) images: &'a [Arc<Image>],
    /// Device bank with which the device names in the images are resolved.
    pub(super) bank: &'a mut dyn DeviceBank,
    /// Policy for discontinuities of commands for which the recording stores none.
    pub(super) continuity: Continuity,
}

impl RequestDecoder<'_> {
    /// Decodes a request from a JSON object; `None` if the object is not a valid request.
    pub(super) fn decode(&mut self, object: &Value) -> Option<(Ticket, Request<()>)> {
        let ticket = Ticket(object["ticket"].as_u64()?);
        let command = || object["command"].as_u64().map(CommandId::from_number);
        let rule = || object["rule"].as_u64().map(RuleId);
        let request = match object["ask"].as_str()? {
            "load" => Request::Insert(command()?, self.load_command(object)?, None),
            "start" => Request::Start(command()?),
            "unschedule" => Request::Unschedule(command()?),
            "cancel" => Request::Cancel(command()?),
            "abort" => Request::Abort(command()?, reason_from_keyword(object["why"].as_str()?)?),
            "unload" => Request::Unload(command()?),
            "schedule" => {
                let made = Rule::from_words(&decode_words(&object["words"])?)?;
                Request::Schedule(rule()?, Box::new(made))
            }
            "withdraw" => Request::Withdraw(rule()?),
            "set" => {
                let settings = object["settings"].as_array()?.iter().map(decode_setting);
                Request::Set(settings.collect::<Option<_>>()?)
            }
            "subscribe" => {
                // The samples are discarded: the values of the flows are on the tick log.
                let subscription = Subscription::new(command()?, &[], object["every"].as_u64()?);
                Request::Subscribe(Box::new(subscription))
            }
            "set-controls" => {
                let share = decode_words(&object["override"])?;
                Request::SetControls(MotionControls {
                    speed_override: f64::from_bits(*share.first()?),
                    paused: object["paused"].as_bool()?,
                })
            }
            "make-safe" => {
                let resources = object["resources"].as_array()?.iter();
                let number = |resource: &Value| u32::try_from(resource.as_u64()?).ok();
                Request::MakeSafe(resources.map(number).collect::<Option<_>>()?)
            }
            "emergency-stop" => Request::EmergencyStop,
            _ => return None,
        };
        Some((ticket, request))
    }

    fn load_command(&mut self, object: &Value) -> Option<Box<Command>> {
        let image = usize::try_from(object["image"].as_u64()?).ok()?;
        let mut command = Command::load(Arc::clone(self.images.get(image)?), self.bank).ok()?;
        // Older recordings have no policy per command, only one for the whole core.
        let own = object["on_jump"].as_str().and_then(policy_from_keyword);
        command.set_continuity(own.unwrap_or(self.continuity));
        let on_overrun = object["on_overrun"].as_str().and_then(|p| p.parse().ok());
        command.set_overrun_policy(on_overrun.unwrap_or_default());
        Some(Box::new(command))
    }
}

fn decode_setting(object: &Value) -> Option<InputValue> {
    Some(InputValue {
        command: CommandId::from_number(object["command"].as_u64()?),
        input: usize::try_from(object["input"].as_u64()?).ok()?,
        value: decode_words(&object["value"])?.into(),
    })
}

fn decode_words(list: &Value) -> Option<Vec<u64>> {
    let word = |word: &Value| u64::from_str_radix(word.as_str()?, 16).ok();
    list.as_array()?.iter().map(word).collect()
}
