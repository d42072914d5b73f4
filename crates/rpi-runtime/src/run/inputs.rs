//! Input values from the command line: `key=value`.

use std::fmt;
use std::str::FromStr;

use rpi_image::Image;

/// Value that the user gives for an input of a command, as a key and a text.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct InputSetting {
    /// Key of the input in the image: the name of a parameter, or of a value that the command takes from its
    /// predecessor.
    pub key: String,
    /// Text form of the value, a literal of the input's type.
    pub value: String,
}

/// Error: a text on the command line does not have the form `key=value`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ParseInputSettingError;

impl fmt::Display for ParseInputSettingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("expected key=value")
    }
}

impl std::error::Error for ParseInputSettingError {}

impl FromStr for InputSetting {
    type Err = ParseInputSettingError;

    fn from_str(text: &str) -> Result<InputSetting, ParseInputSettingError> {
        let (key, value) = text.split_once('=').ok_or(ParseInputSettingError)?;
        Ok(InputSetting {
            key: key.trim().to_owned(),
            value: value.trim().to_owned(),
        })
    }
}

/// Error: a value that the user gives for an input cannot be applied.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum InputSettingError {
    /// No command of the run has an input with this key.
    UndefinedInput {
        /// Key of the input that the user has given.
        key: String,
        /// Keys of all inputs of the run's commands.
        known: Vec<String>,
    },
    /// The text is not a valid value of the input's type.
    InvalidValue {
        /// Key of the input that the user has given.
        key: String,
        /// Description of the error.
        message: String,
    },
}

impl fmt::Display for InputSettingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            InputSettingError::UndefinedInput { key, known } if known.is_empty() => {
                write!(f, "undefined input {key}: there are no inputs")
            }
            InputSettingError::UndefinedInput { key, known } => {
                write!(f, "undefined input {key} (inputs: {})", known.join(", "))?;
                match rpi_words::suggest(key, known.iter().map(String::as_str)) {
                    Some(meant) => write!(f, "; did you mean {meant}?"),
                    None => Ok(()),
                }
            }
            InputSettingError::InvalidValue { key, message } => write!(f, "{key}: {message}"),
        }
    }
}

impl std::error::Error for InputSettingError {}

/// Index of an input in its image, and the memory slots of the value for it.
pub(super) type IndexedValue = (usize, Vec<u64>);

/// Converts the values that the user gives for inputs. Returns for each image a list of input indices and values.
///
/// # Errors
/// If no image has an input with a given key, or a value has the wrong type.
pub(super) fn resolve(
    settings: &[InputSetting],
    images: &[&Image],
) -> Result<Vec<Vec<IndexedValue>>, InputSettingError> {
    for setting in settings {
        let mut inputs = images.iter().flat_map(|image| &image.inputs);
        if !inputs.any(|input| input.key == setting.key) {
            let known = images.iter().flat_map(|image| &image.inputs);
            let mut known: Vec<String> = known.map(|input| input.key.clone()).collect();
            known.sort();
            known.dedup();
            let key = setting.key.clone();
            return Err(InputSettingError::UndefinedInput { key, known });
        }
    }
    images
        .iter()
        .map(|image| resolve_image(settings, image))
        .collect()
}

fn resolve_image(
    settings: &[InputSetting],
    image: &Image,
) -> Result<Vec<IndexedValue>, InputSettingError> {
    let mut sets = Vec::new();
    for (index, input) in image.inputs.iter().enumerate() {
        for setting in settings.iter().filter(|s| s.key == input.key) {
            let bad = |message: String| InputSettingError::InvalidValue {
                key: setting.key.clone(),
                message,
            };
            let ty = input.value.ty;
            let value = rpi_literal::parse(&setting.value, ty)
                .map_err(|e| bad(format!("`{}` is not a {ty}: {e}", setting.value)))?;
            let value = value.ok_or_else(|| bad(format!("an input of type {ty} needs a value")))?;
            sets.push((index, value.slots().to_vec()));
        }
    }
    Ok(sets)
}

#[cfg(test)]
mod tests {
    use rpi_image::image::{InputPort, Signal};
    use rpi_image::{Scalar, Type};

    use super::*;

    fn image() -> Image {
        let value = Signal {
            start: 2,
            present: 1,
            ty: Type::Scalar(Scalar::Real),
        };
        Image {
            inputs: vec![InputPort {
                key: "speed".into(),
                unit: String::new(),
                value,
                last_updated: None,
            }],
            ..Image::default()
        }
    }

    fn resolved(text: &str) -> Result<Vec<Vec<IndexedValue>>, InputSettingError> {
        resolve(&[text.parse().unwrap()], &[&image()])
    }

    #[test]
    fn a_setting_finds_its_input() {
        let cells = 0.5f64.to_bits();
        assert_eq!(resolved("speed = 0.5").unwrap(), [[(0, vec![cells])]]);
    }

    #[test]
    fn what_does_not_fit_is_told_with_a_way_out() {
        let message = |text| resolved(text).unwrap_err().to_string();
        assert!(message("sped=1").contains("did you mean speed?"));
        assert!(message("speed=fast").contains("expected a number"));
        assert!(message("speed=null").contains("needs a value"));
        assert!("speed".parse::<InputSetting>().is_err());
    }
}
