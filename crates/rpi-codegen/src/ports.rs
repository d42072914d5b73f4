//! Fields of the input and output structs.

use crate::access::response_type;
use crate::c_type::CType;
use crate::identifiers::Names;
use crate::slots::Slots;
use rpi_image::image::{CommandEnd, CommandEndKind, DevicePort, Image, Signal, SlotRange, TRUE};
use rpi_image::{CommandFlow, DeviceResponse};
use std::collections::BTreeMap;

/// Struct that contains a field.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Direction {
    /// Input struct, which the caller fills before each cycle.
    Input,
    /// Output struct, which a cycle fills.
    Output,
}

/// Meaning of a field. Indices refer to the tables of the image.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum Meaning {
    /// External slots that start at this index: a sample of a sensor, an input or a flow of the core.
    External(u32),
    /// Presence of an external flow, in the slot with this index.
    ExternalPresence(u32),
    /// Response of a device to the set-point of the actuator port with this index.
    Response(u32, DeviceResponse),
    /// Whether a successor takes over if the command yields.
    HasSuccessor,
    /// Value of the export with this index.
    Export(u32),
    /// Presence of the export with this index.
    ExportPresence(u32),
    /// Set-point for the actuator port with this index.
    SetPoint(u32),
    /// Whether there is a set-point for the actuator port with this index in this cycle.
    SetPointPresence(u32),
    /// Number of the result with which the command ends, counted from 1; 0 if it continues.
    Result,
    /// Whether the net has ended, by its port `terminate`.
    Terminated,
    /// Error number of the net, from its port `fail`.
    ErrorNumber,
}

/// Field of the input or output struct.
#[derive(Clone, PartialEq, Debug)]
pub struct Field {
    /// Struct that contains the field.
    pub direction: Direction,
    /// Name of the field.
    pub name: String,
    /// C type of one element.
    pub ty: CType,
    /// Number of elements; 1 for a single value.
    pub len: u32,
    /// Meaning of the field.
    pub meaning: Meaning,
    /// Unit of the values, such as `m/s`; empty if they have none.
    pub unit: String,
    /// Description for the comment in the header, with the type.
    pub text: String,
}

impl Field {
    fn new(
        direction: Direction,
        name: impl Into<String>,
        ty: CType,
        len: u32,
        meaning: Meaning,
        text: impl Into<String>,
    ) -> Field {
        Field {
            direction,
            name: name.into(),
            ty,
            len,
            meaning,
            unit: String::new(),
            text: text.into(),
        }
    }

    /// Gives the values a unit, which the description has with the type, as in programs: `real[m/s]`.
    fn with_unit(mut self, unit: &str) -> Field {
        if !unit.is_empty() {
            unit.clone_into(&mut self.unit);
            self.text = format!("{}[{unit}]", self.text);
        }
        self
    }
}

/// Fields of the input and output structs, in the order of the structs.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Interface {
    /// All fields.
    pub fields: Vec<Field>,
    names: BTreeMap<(bool, Meaning), String>,
}

impl Interface {
    pub(crate) fn new(image: &Image, slots: &Slots) -> Interface {
        let mut builder = Builder {
            slots,
            inputs: Names::default(),
            outputs: Names::default(),
            interface: Interface::default(),
        };
        builder.inputs.unique("device");
        builder.outputs.unique("fault");
        builder.inputs(image);
        builder.outputs(image);
        builder.interface
    }

    /// Returns the fields of one struct.
    pub fn of(&self, direction: Direction) -> impl Iterator<Item = &Field> {
        self.fields.iter().filter(move |f| f.direction == direction)
    }

    /// Returns the name of the input field in a slot, with a value or a presence; `None` if there is none.
    pub(crate) fn object(&self, start: u32) -> Option<&str> {
        let value = self.name(Direction::Input, Meaning::External(start));
        value.or_else(|| self.name(Direction::Input, Meaning::ExternalPresence(start)))
    }

    /// Returns the name of the field with a meaning in a struct; `None` if there is none.
    #[must_use]
    pub fn name(&self, direction: Direction, meaning: Meaning) -> Option<&str> {
        let key = (direction == Direction::Output, meaning);
        self.names.get(&key).map(String::as_str)
    }
}

/// Returns the index of the first actuator with the same port: two steps may drive one port in turn.
pub(crate) fn shared_actuator(image: &Image, actuator: u32) -> u32 {
    let port = &image.actuators[actuator as usize].port;
    let first = image.actuators.iter().position(|a| a.port == *port);
    first.map_or(actuator, |k| k as u32)
}

/// Returns whether the caller sets a flow of the core. The others are computed from the number of the cycle.
pub(crate) fn is_set_by_caller(flow: CommandFlow) -> bool {
    !matches!(
        flow,
        CommandFlow::Time | CommandFlow::Elapsed | CommandFlow::Period | CommandFlow::PeriodTicks
    )
}

fn flow_name(flow: CommandFlow) -> (&'static str, &'static str) {
    match flow {
        CommandFlow::Cancel => ("cancel", "true after a request to cancel the command"),
        CommandFlow::Takeover => (
            "takeover",
            "true if a successor takes over every moving device",
        ),
        CommandFlow::NetTime => (
            "net_time",
            "logical time of the cycle, ns since the Unix epoch",
        ),
        CommandFlow::WallTime => (
            "wall_time",
            "time of the system clock, ns since the Unix epoch",
        ),
        CommandFlow::Predecessor => ("predecessor", "identification of the preceding command"),
        CommandFlow::SpeedOverride => (
            "speed_override",
            "share of the speed of all motions, 0 to 1",
        ),
        CommandFlow::Pause => ("pause", "true while all motions pause"),
        CommandFlow::Time | CommandFlow::Period => ("time", "time in s"),
        CommandFlow::Elapsed | CommandFlow::PeriodTicks => ("ticks", "time in ticks"),
    }
}

fn response_name(response: DeviceResponse) -> (&'static str, &'static str) {
    match response {
        DeviceResponse::ConcurrentAccess => ("concurrent", "whether another step has set the port"),
        DeviceResponse::DeviceFailed => ("failed", "whether the device has failed"),
        DeviceResponse::IllegalValue => ("illegal", "whether the device rejects the set-point"),
        DeviceResponse::ErrorCode => ("error", "error code of the device, 0 if there is none"),
        DeviceResponse::Completed => (
            "completed",
            "whether the device accepted the last set-point",
        ),
    }
}

fn port_text(port: &DevicePort) -> String {
    match port.index {
        0 => format!("{}_{}", port.device, port.port),
        index => format!("{}_{}_{index}", port.device, port.port),
    }
}

struct Builder<'a> {
    slots: &'a Slots,
    inputs: Names,
    outputs: Names,
    interface: Interface,
}

impl Builder<'_> {
    /// Adds a field under a name that no other field of its struct has.
    fn add(&mut self, mut field: Field) {
        let names = match field.direction {
            Direction::Input => &mut self.inputs,
            Direction::Output => &mut self.outputs,
        };
        field.name = names.unique(&field.name);
        let key = (field.direction == Direction::Output, field.meaning);
        self.interface.names.insert(key, field.name.clone());
        self.interface.fields.push(field);
    }

    /// Adds a field with a single value.
    fn single(
        &mut self,
        direction: Direction,
        name: impl Into<String>,
        ty: CType,
        meaning: Meaning,
        text: &str,
    ) {
        self.add(Field::new(direction, name, ty, 1, meaning, text));
    }

    fn external(&mut self, name: &str, (signal, unit): (Signal, &str), text: &str) {
        let object = self.slots.object(signal.start);
        let meaning = Meaning::External(object.start);
        if self.interface.name(Direction::Input, meaning).is_none() {
            let (ty, len) = (self.slots.ty(object.start), object.len);
            let text = format!("{text}: {}", signal.ty);
            let field = Field::new(Direction::Input, name, ty, len, meaning, text);
            self.add(field.with_unit(unit));
        }
        if signal.present > TRUE {
            let name = format!("{name}_present");
            let meaning = Meaning::ExternalPresence(signal.present);
            if self.interface.name(Direction::Input, meaning).is_none() {
                let text = "whether there is a value in this cycle";
                self.single(Direction::Input, name, CType::Bool, meaning, text);
            }
        }
    }

    fn inputs(&mut self, image: &Image) {
        for input in &image.inputs {
            let text = format!("input `{}`", input.key);
            self.external(&input.key, (input.value, &input.unit), &text);
            // Most programs do not ask when a value came.
            let is_used = |s: &Signal| {
                let present = SlotRange {
                    start: s.present,
                    len: 1,
                };
                self.slots.is_used(s.slots()) || s.present > TRUE && self.slots.is_used(present)
            };
            if let Some(updated) = input.last_updated.filter(is_used) {
                let name = format!("{}_updated", input.key);
                self.external(
                    &name,
                    (updated, ""),
                    "time of the last update, ns since the Unix epoch",
                );
            }
        }
        for sensor in &image.sensors {
            let text = format!(
                "sensor {}.{}[{}]",
                sensor.port.device, sensor.port.port, sensor.port.index
            );
            self.external(&port_text(&sensor.port), (sensor.value, ""), &text);
        }
        for flow in image.flows.iter().filter(|f| is_set_by_caller(f.kind)) {
            let (name, text) = flow_name(flow.kind);
            self.external(name, (flow.value, ""), text);
        }
        self.responses(image);
        if let CommandEnd::Results(results) = &image.end
            && results.iter().any(|r| r.kind == CommandEndKind::Yield)
        {
            let text = "whether a successor takes over if the command yields";
            self.single(
                Direction::Input,
                "has_successor",
                CType::Bool,
                Meaning::HasSuccessor,
                text,
            );
        }
    }

    fn responses(&mut self, image: &Image) {
        for (k, actuator) in (0..).zip(&image.actuators) {
            let shared = shared_actuator(image, k);
            for (response, _) in &actuator.responses {
                let meaning = Meaning::Response(shared, *response);
                // Whether two steps set the port is known without the caller.
                let is_known = *response == DeviceResponse::ConcurrentAccess;
                if is_known || self.interface.name(Direction::Input, meaning).is_some() {
                    continue;
                }
                let (suffix, text) = response_name(*response);
                let name = format!("{}_{suffix}", port_text(&actuator.port));
                self.single(
                    Direction::Input,
                    name,
                    response_type(*response),
                    meaning,
                    text,
                );
            }
        }
    }

    fn outputs(&mut self, image: &Image) {
        for (k, export) in (0..).zip(&image.exports) {
            let ty = CType::of_type(export.value.ty);
            let text = format!("flow `{}`: {}", export.key, export.value.ty);
            let (len, meaning) = (export.value.ty.slots(), Meaning::Export(k));
            let field = Field::new(Direction::Output, &export.key, ty, len, meaning, text);
            self.add(field.with_unit(&export.unit));
            if export.value.present != TRUE {
                let name = format!("{}_present", export.key);
                let text = "whether the flow has a value in this cycle";
                self.single(
                    Direction::Output,
                    name,
                    CType::Bool,
                    Meaning::ExportPresence(k),
                    text,
                );
            }
        }
        for (k, actuator) in (0..).zip(&image.actuators) {
            if shared_actuator(image, k) == k {
                self.set_point(k, &actuator.port, &actuator.inputs);
            }
        }
        self.end(&image.end);
    }

    fn end(&mut self, end: &CommandEnd) {
        match end {
            CommandEnd::Results(results) if results.is_empty() => {}
            CommandEnd::Results(_) => {
                let text = "number of the result with which the command ends, else 0";
                self.end_field("result", CType::Int, Meaning::Result, text);
            }
            CommandEnd::Ports { terminate, fail } => {
                // A node has neither.
                if terminate.is_some() {
                    let text = "whether the command ends";
                    self.end_field("terminated", CType::Bool, Meaning::Terminated, text);
                }
                if fail.is_some() {
                    let text = "error number with which the command ends, 0 if there is none";
                    self.end_field("error_number", CType::Int, Meaning::ErrorNumber, text);
                }
            }
        }
    }

    fn end_field(&mut self, name: &str, ty: CType, meaning: Meaning, text: &str) {
        self.single(Direction::Output, name, ty, meaning, text);
    }

    fn set_point(&mut self, actuator: u32, port: &DevicePort, inputs: &[SlotRange]) {
        let name = port_text(port);
        let ty = CType::of_type(port.ty);
        let len = inputs.iter().map(|i| i.len).sum();
        let text = format!(
            "set-point for {}.{}[{}]: {}",
            port.device, port.port, port.index, port.ty
        );
        self.add(Field::new(
            Direction::Output,
            &name,
            ty,
            len,
            Meaning::SetPoint(actuator),
            text,
        ));
        let text = "whether there is a set-point in this cycle";
        let name = format!("{name}_present");
        self.single(
            Direction::Output,
            name,
            CType::Bool,
            Meaning::SetPointPresence(actuator),
            text,
        );
    }
}
