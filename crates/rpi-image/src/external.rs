//! Functions that are defined outside of the program, with their signature in C.
//!
//! A net has the signature as a text parameter, an image as this type. The values of a call are grouped by kind: reals,
//! integers, Booleans, each in the order of the ports.

use crate::types::{Scalar, Type};
use alloc::format;
use alloc::string::{String, ToString};
use alloc::vec::Vec;
use core::fmt::{self, Display};

/// Name that takes the place of a device for all external functions. It is a keyword, so no device has it.
pub const EXTERNAL_DEVICE: &str = "extern";

/// Kinds of values that can be passed to C, in the order in which a call groups them.
pub const EXTERNAL_KINDS: [Scalar; 3] = [Scalar::Real, Scalar::Int, Scalar::Bool];

/// Maximum number of values of an external function, so that a wrong image cannot make a reader allocate much.
const MAX_VALUES: u32 = 1 << 20;

/// Function in C that a program calls.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct ExternalFunction {
    /// Name of the function in C.
    pub symbol: String,
    /// Name of the function in the program.
    pub name: String,
    /// In-ports in the order of the declaration.
    pub inputs: Vec<ExternalPort>,
    /// Out-ports in the order of the declaration.
    pub outputs: Vec<ExternalPort>,
}

/// Port of an external function.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct ExternalPort {
    /// Name of the port.
    pub name: String,
    /// Kind of its values: one of [`EXTERNAL_KINDS`].
    pub kind: Scalar,
    /// Number of values; 1 for a single value.
    pub len: u32,
    /// Whether the values are an array, which is passed by its address.
    pub is_array: bool,
    /// Type in the program, with its unit.
    pub ty: String,
}

impl ExternalFunction {
    /// Returns the values of one kind among ports: for each port of this kind, its index, the offset of its first value
    /// within the values of the kind, and its number of values.
    pub fn group(
        ports: &[ExternalPort],
        kind: Scalar,
    ) -> impl Iterator<Item = (usize, u32, u32)> + '_ {
        let own = ports.iter().enumerate().filter(move |p| p.1.kind == kind);
        own.scan(0_u32, |offset, (index, port)| {
            let at = *offset;
            *offset = at.saturating_add(port.len);
            Some((index, at, port.len))
        })
    }

    /// Returns the number of values of one kind among ports.
    #[must_use]
    pub fn group_len(ports: &[ExternalPort], kind: Scalar) -> u32 {
        let own = ports.iter().filter(|p| p.kind == kind);
        own.fold(0, |sum, p| sum.saturating_add(p.len))
    }

    /// Returns the numbers of values of all kinds that occur among ports, in the order of a call.
    pub fn group_lens(ports: &[ExternalPort]) -> impl Iterator<Item = (Scalar, u32)> + '_ {
        let kinds = EXTERNAL_KINDS.iter();
        let lens = kinds.map(|kind| (*kind, ExternalFunction::group_len(ports, *kind)));
        lens.filter(|(_, len)| *len > 0)
    }

    /// Returns the only out-port if it is a single value. C returns it as the result of the function.
    #[must_use]
    pub fn result(&self) -> Option<&ExternalPort> {
        match &self.outputs[..] {
            [port] if !port.is_array => Some(port),
            _ => None,
        }
    }

    /// Reads a signature in the form of its [`Display`] implementation; `None` if it has another form, or is not a
    /// signature that C can have.
    #[must_use]
    pub fn from_text(text: &str) -> Option<ExternalFunction> {
        let mut parts = text.split('\n');
        let (symbol, name) = (parts.next()?, parts.next()?);
        let (inputs, outputs) = (parts.next()?, parts.next()?);
        let function = ExternalFunction {
            symbol: symbol.to_string(),
            name: name.to_string(),
            inputs: ports_from_text(inputs)?,
            outputs: ports_from_text(outputs)?,
        };
        (parts.next().is_none() && function.is_valid()).then_some(function)
    }

    /// Returns whether the names are names in C and the ports are such that C can have them.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        let ports = || self.inputs.iter().chain(&self.outputs);
        let sound = |p: &ExternalPort| {
            EXTERNAL_KINDS.contains(&p.kind) && p.len > 0 && (p.is_array || p.len == 1)
        };
        let values = ports().fold(0_u32, |sum, p| sum.saturating_add(p.len));
        is_c_name(&self.symbol)
            && !self.outputs.is_empty()
            && ports().all(sound)
            && values <= MAX_VALUES
    }
}

/// Returns whether a text is an identifier in C.
#[must_use]
pub fn is_c_name(text: &str) -> bool {
    let is_letter = |c: char| c.is_ascii_alphabetic() || c == '_';
    let starts = text.starts_with(is_letter);
    starts && text.chars().all(|c| is_letter(c) || c.is_ascii_digit())
}

impl Display for ExternalFunction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ports = |ports: &[ExternalPort]| {
            let texts: Vec<String> = ports.iter().map(port_text).collect();
            texts.join(";")
        };
        let (inputs, outputs) = (ports(&self.inputs), ports(&self.outputs));
        write!(f, "{}\n{}\n{inputs}\n{outputs}", self.symbol, self.name)
    }
}

fn port_text(port: &ExternalPort) -> String {
    let form = if port.is_array { "array" } else { "value" };
    let kind = Type::Scalar(port.kind);
    format!("{}:{kind}:{}:{form}:{}", port.name, port.len, port.ty)
}

fn ports_from_text(text: &str) -> Option<Vec<ExternalPort>> {
    let parts = text.split(';').filter(|part| !part.is_empty());
    parts.map(port_from_text).collect()
}

fn port_from_text(text: &str) -> Option<ExternalPort> {
    let mut fields = text.splitn(5, ':');
    let (name, kind) = (fields.next()?, fields.next()?);
    let (len, form, ty) = (fields.next()?, fields.next()?, fields.next()?);
    let mut kinds = EXTERNAL_KINDS.iter();
    Some(ExternalPort {
        name: name.to_string(),
        kind: *kinds.find(|k| Type::Scalar(**k).to_string() == kind)?,
        len: len.parse().ok()?,
        is_array: form == "array",
        ty: ty.to_string(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;

    fn port(name: &str, kind: Scalar, len: u32, is_array: bool) -> ExternalPort {
        ExternalPort {
            name: name.to_string(),
            kind,
            len,
            is_array,
            ty: "real<m>".to_string(),
        }
    }

    #[test]
    fn a_signature_is_read_back() {
        let function = ExternalFunction {
            symbol: "c_norm".to_string(),
            name: "norm".to_string(),
            inputs: vec![
                port("x", Scalar::Real, 3, true),
                port("n", Scalar::Int, 1, false),
            ],
            outputs: vec![port("y", Scalar::Bool, 1, true)],
        };
        let text = function.to_string();
        assert_eq!(ExternalFunction::from_text(&text), Some(function));
        let wrong = text.replace("c_norm", "system()");
        assert_eq!(ExternalFunction::from_text(&wrong), None);
        assert_eq!(
            ExternalFunction::from_text(&text.replace(":3:", ":0:")),
            None
        );
        assert_eq!(ExternalFunction::from_text("c_norm"), None);
    }
}
