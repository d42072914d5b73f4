//! Encodes requests as JSON and decodes them.
//!
//! Example: `{"ticket":7,"ask":"start","command":4294967297}`. Commands and rules are written as numbers. The 64-bit
//! words of values and rules are written as hexadecimal strings, because JSON readers keep only 53 bits of a number.

use std::sync::Arc;

use rpi_core::{Command, CommandId, Continuity, Rule, RuleId};
use rpi_device::DeviceBank;
use rpi_image::Image;
use serde_json::{Value, json};

use super::names::Names;
use super::recorder::{policy_by_word, word_of_policy};
use super::told::{why_by_word, word_of};
use rpi_runtime::control::{Asked, Request, Setting, Subscription, Ticket};

/// Encodes a request as a JSON object.
pub(super) fn write(ticket: Ticket, asked: &Asked, names: &Names) -> Value {
    let about = |ask: &str, id: &CommandId| json!({ "ask": ask, "command": id.number(), "name": names.of_command(*id) });
    let mut object = match asked {
        Asked::Load(id, _, continuity, on_overrun) => {
            let mut object = about("load", id);
            object["image"] = json!(names.image_of(*id));
            object["on_jump"] = json!(word_of_policy(*continuity));
            object["on_overrun"] = json!(on_overrun.to_string());
            object
        }
        Asked::Start(id) => about("start", id),
        Asked::Unschedule(id) => about("unschedule", id),
        Asked::Cancel(id) => about("cancel", id),
        Asked::Abort(id, why) => {
            let mut object = about("abort", id);
            object["why"] = json!(word_of(*why));
            object
        }
        Asked::Unload(id) => about("unload", id),
        Asked::Schedule(rule, made) => {
            json!({ "ask": "schedule", "rule": rule.0, "words": hexadecimal(&made.to_words()) })
        }
        Asked::Withdraw(rule) => json!({ "ask": "withdraw", "rule": rule.0 }),
        Asked::Set(settings) => {
            json!({ "ask": "set", "settings": settings.iter().map(setting).collect::<Vec<_>>() })
        }
        Asked::Subscribe(id, exports, every) => {
            let mut object = about("subscribe", id);
            (object["exports"], object["every"]) = (json!(exports), json!(every));
            object
        }
        Asked::Device(place) => json!({ "ask": "device", "place": place }),
        Asked::EmergencyStop => json!({ "ask": "emergency-stop" }),
    };
    object["ticket"] = json!(ticket.0);
    object
}

fn setting(setting: &Setting) -> Value {
    let (command, input) = (setting.command.number(), setting.input);
    json!({ "command": command, "input": input, "value": hexadecimal(&setting.value) })
}

fn hexadecimal(words: &[u64]) -> Vec<String> {
    words.iter().map(|word| format!("{word:x}")).collect()
}

/// Decodes recorded requests so that they can be made again.
pub(super) struct Maker<'a> {
    /// Images of the recording, indexed by their numbers.
    pub(super) images: &'a [Arc<Image>],
    /// Device bank that resolves the names of ports.
    pub(super) bank: &'a mut dyn DeviceBank,
    /// Default continuity policy of the recorded core.
    pub(super) continuity: Continuity,
}

impl Maker<'_> {
    /// Decodes a request from a JSON object; `None` if the object is not a valid request.
    pub(super) fn read(&mut self, object: &Value) -> Option<(Ticket, Request<()>)> {
        let ticket = Ticket(object["ticket"].as_u64()?);
        let command = || object["command"].as_u64().map(CommandId::from_number);
        let rule = || object["rule"].as_u64().map(RuleId);
        let request = match object["ask"].as_str()? {
            "load" => Request::Insert(command()?, self.load(object)?, None),
            "start" => Request::Start(command()?),
            "unschedule" => Request::Unschedule(command()?),
            "cancel" => Request::Cancel(command()?),
            "abort" => Request::Abort(command()?, why_by_word(object["why"].as_str()?)?),
            "unload" => Request::Unload(command()?),
            "schedule" => {
                let made = Rule::from_words(&words(&object["words"])?)?;
                Request::Schedule(rule()?, Box::new(made))
            }
            "withdraw" => Request::Withdraw(rule()?),
            "set" => {
                let settings = object["settings"].as_array()?.iter().map(set);
                Request::Set(settings.collect::<Option<_>>()?)
            }
            "subscribe" => {
                // The samples are discarded: the values of the flows are on the tape.
                let subscription = Subscription::new(command()?, &[], object["every"].as_u64()?);
                Request::Subscribe(Box::new(subscription))
            }
            "emergency-stop" => Request::EmergencyStop,
            _ => return None,
        };
        Some((ticket, request))
    }

    fn load(&mut self, object: &Value) -> Option<Box<Command>> {
        let image = usize::try_from(object["image"].as_u64()?).ok()?;
        let mut command = Command::load(Arc::clone(self.images.get(image)?), self.bank).ok()?;
        // Older recordings have no policy per command, only one for the whole core.
        let own = object["on_jump"].as_str().and_then(policy_by_word);
        command.guard(own.unwrap_or(self.continuity));
        let on_overrun = object["on_overrun"].as_str().and_then(|p| p.parse().ok());
        command.bound_overruns(on_overrun.unwrap_or_default());
        Some(Box::new(command))
    }
}

fn set(object: &Value) -> Option<Setting> {
    Some(Setting {
        command: CommandId::from_number(object["command"].as_u64()?),
        input: usize::try_from(object["input"].as_u64()?).ok()?,
        value: words(&object["value"])?.into(),
    })
}

fn words(list: &Value) -> Option<Vec<u64>> {
    let word = |word: &Value| u64::from_str_radix(word.as_str()?, 16).ok();
    list.as_array()?.iter().map(word).collect()
}
