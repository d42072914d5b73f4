//! Reading of parameters, with errors that name the parameter and the expected type.

use std::time::Duration;

use rpi_core::CommandOverrunPolicy;
use serde_json::{Map, Value, json};

use super::connection::{Call, RpcConnection};
use crate::state::{ApiError, Language, LoadRequest};

impl<'a> Call<'a> {
    /// Returns the request to load a command or task, read from the parameters. `named` is the key of the parameter
    /// with the name of the command or task to load, which the text may have several of.
    pub(super) fn load(&self, named: &str) -> Result<LoadRequest<'a>, ApiError> {
        let languages = [("rpi", Language::Rpi), ("rpinet", Language::Rpinet)];
        let language = self.one_of("language", &languages)?;
        Ok(LoadRequest {
            session: self.text("session")?,
            title: self.optional("title", text_type())?.unwrap_or_default(),
            language: language.unwrap_or(Language::Rpi),
            text: self.text("text")?,
            command: self.optional(named, text_type())?,
            period_ns: u64::try_from(self.seconds("period", 0.0)?.as_nanos()).unwrap_or(u64::MAX),
            on_overrun: self.on_overrun()?,
            watch: self.watched_flows()?,
        })
    }

    /// Returns the names of flows in the parameter `watch`; an empty list without this parameter.
    fn watched_flows(&self) -> Result<Vec<&'a str>, ApiError> {
        let names = self.texts("watch")?;
        match names.len() {
            0..=MAX_WATCHED_NAMES => Ok(names),
            count => Err(ApiError::Invalid(format!(
                "watch: at most {MAX_WATCHED_NAMES} names, found {count}; the name of a command, call or fragment stands for all flows inside"
            ))),
        }
    }

    /// Returns the policy in the parameter `on_overrun` for cycles that take too long; `None` without this parameter.
    fn on_overrun(&self) -> Result<Option<CommandOverrunPolicy>, ApiError> {
        let text = self.optional("on_overrun", text_type())?;
        let policy = text.map(str::parse).transpose();
        policy.map_err(|why| ApiError::Invalid(format!("on_overrun: {why}")))
    }

    /// Returns a function that makes the answer to a load request from the kind and name of the loaded object. The
    /// answer has the name, the period in seconds, and whether the requested period was rounded to whole ticks.
    pub(super) fn period_answer(
        &self,
        front: &RpcConnection,
        requested_ns: u64,
    ) -> impl FnOnce(&str, String) -> Value + Send + 'static {
        let period_ns = front.state.lock().defaults.round_period(requested_ns);
        move |kind, name| {
            let mut answer = json!({"period": period_ns as f64 * 1e-9});
            answer[kind] = json!(name);
            if requested_ns > 0 && requested_ns != period_ns {
                answer["rounded"] = json!(true);
            }
            answer
        }
    }

    /// Returns the Boolean parameter `key`; false if it is missing.
    pub(super) fn boolean(&self, key: &str) -> Result<bool, ApiError> {
        Ok(self.optional(key, boolean_type())?.unwrap_or(false))
    }

    /// Returns the number in the parameter `key`, which must be from 0 to 1; `None` without this parameter.
    pub(super) fn optional_share(&self, key: &str) -> Result<Option<f64>, ApiError> {
        let share = self.optional(key, number_type())?;
        match share {
            Some(value) if !(0.0..=1.0).contains(&value) => Err(ApiError::Invalid(format!(
                "{key}: expected a share from 0 to 1, found {value:?}"
            ))),
            share => Ok(share),
        }
    }

    /// Returns the Boolean parameter `key`; `None` if it is missing.
    pub(super) fn optional_flag(&self, key: &str) -> Result<Option<bool>, ApiError> {
        self.optional(key, boolean_type())
    }

    /// Returns the value that `words` assigns to the word in the parameter `key`; `None` if the parameter is missing.
    /// Any other word is an error.
    pub(super) fn one_of<T: Copy>(
        &self,
        key: &str,
        words: &[(&str, T)],
    ) -> Result<Option<T>, ApiError> {
        let Some(word) = self.optional(key, text_type())? else {
            return Ok(None);
        };
        let found = words.iter().find(|(known, _)| *known == word);
        let known = || words.iter().map(|(known, _)| *known).collect::<Vec<_>>();
        let bad = || ApiError::Invalid(format!("{key}: expected one of {}", known().join(", ")));
        found.map(|(_, meant)| Some(*meant)).ok_or_else(bad)
    }

    /// Returns the parameter `key`, `None` if it is missing, or an error if its value has the wrong type.
    pub(super) fn optional<T>(
        &self,
        key: &str,
        (what, read): ParamType<'a, T>,
    ) -> Result<Option<T>, ApiError> {
        match self.params.get(key) {
            None | Some(Value::Null) => Ok(None),
            Some(value) => {
                let bad = || {
                    ApiError::Invalid(format!(
                        "{key}: expected {what}, found {}",
                        type_name(value)
                    ))
                };
                read(value).map(Some).ok_or_else(bad)
            }
        }
    }

    /// Returns the parameter `key`, or an error if it is missing or its value has the wrong type.
    pub(super) fn required<T>(&self, key: &str, kind: ParamType<'a, T>) -> Result<T, ApiError> {
        let lacks = || ApiError::Invalid(format!("the parameter {key} is missing: {}", kind.0));
        self.optional(key, kind)?.ok_or_else(lacks)
    }

    /// Returns the text in the parameter `key`, or an error if the parameter is missing.
    pub(super) fn text(&self, key: &str) -> Result<&'a str, ApiError> {
        self.required(key, text_type())
    }

    /// Returns the list of texts in the parameter `key`; an empty list if the parameter is missing.
    pub(super) fn texts(&self, key: &str) -> Result<Vec<&'a str>, ApiError> {
        Ok(self.optional(key, texts_type())?.unwrap_or_default())
    }

    /// Returns the duration in the parameter `key`, a number of seconds up to [`LONGEST`]; `None` if the parameter is
    /// missing.
    pub(super) fn optional_seconds(&self, key: &str) -> Result<Option<Duration>, ApiError> {
        match self.params.get(key) {
            None | Some(Value::Null) => Ok(None),
            Some(_) => self.seconds(key, 0.0).map(Some),
        }
    }

    /// Returns the duration in the parameter `key`, a number of seconds up to [`LONGEST`]; `unless_said` seconds if the
    /// parameter is missing.
    pub(super) fn seconds(&self, key: &str, unless_said: f64) -> Result<Duration, ApiError> {
        let seconds = self.optional(key, number_type())?.unwrap_or(unless_said);
        let time = Duration::try_from_secs_f64(seconds);
        let usable = time.ok().filter(|time| *time <= LONGEST);
        let most = LONGEST.as_secs();
        let bad = || {
            ApiError::Invalid(format!(
                "{key}: expected 0 to {most} seconds, found {seconds:?}"
            ))
        };
        usable.ok_or_else(bad)
    }
}

/// Maximum number of names in the parameter `watch`. The compiler compares every name with every flow.
const MAX_WATCHED_NAMES: usize = 256;

/// Maximum duration that a client may give in a parameter.
const LONGEST: Duration = Duration::from_secs(3600);

/// Type of a parameter: a description for error messages, and the function that reads the value; the function returns
/// `None` for a value of another type.
pub(super) type ParamType<'a, T> = (&'static str, fn(&'a Value) -> Option<T>);

/// Returns the parameter type that accepts JSON strings.
pub(super) fn text_type<'a>() -> ParamType<'a, &'a str> {
    ("a text", Value::as_str)
}

fn boolean_type<'a>() -> ParamType<'a, bool> {
    ("true or false", Value::as_bool)
}

fn number_type<'a>() -> ParamType<'a, f64> {
    ("a number", Value::as_f64)
}

/// Returns the parameter type that accepts JSON objects.
pub(super) fn object_type<'a>() -> ParamType<'a, &'a Map<String, Value>> {
    ("an object", Value::as_object)
}

fn texts_type<'a>() -> ParamType<'a, Vec<&'a str>> {
    ("a list of texts", |value| {
        value.as_array()?.iter().map(Value::as_str).collect()
    })
}

/// Describes the type of a JSON value for error messages.
fn type_name(value: &Value) -> &'static str {
    match value {
        Value::Null => "null",
        Value::Bool(_) => "true or false",
        Value::Number(_) => "a number",
        Value::String(_) => "a text",
        Value::Array(_) => "a list",
        Value::Object(_) => "an object",
    }
}

/// Returns the literal for a JSON value, as it is parsed for an input: the content of a JSON string, or the JSON text
/// of any other value.
pub(super) fn literal(value: &Value) -> String {
    value
        .as_str()
        .map_or_else(|| value.to_string(), str::to_owned)
}
