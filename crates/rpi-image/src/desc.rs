//! What is known of a primitive besides its code: everything that the type checker, the importer,
//! hover texts, the generated reference, the lowering and the loader read.

use crate::ty::{Scalar, Type};
use crate::value::Value;

/// The declaration of one primitive.
#[derive(Clone, Copy, Debug)]
pub struct PrimDesc {
    /// Registered name, `Core::DoubleAdd`.
    pub name: &'static str,
    /// What it does, with units, frames and source.
    pub doc: &'static str,
    /// In-ports in declaration order.
    pub inputs: &'static [InPort],
    /// Out-ports in declaration order.
    pub outputs: &'static [OutPort],
    /// Parameters that are no fallback of an in-port, in declaration order.
    pub params: &'static [Param],
    /// Lengths of array out-ports, shapes of matrices.
    pub shape: Shape,
    /// Memory kept from cycle to cycle.
    pub state: State,
    /// How the core treats it.
    pub role: Role,
    /// Bound of its work in one cycle, in elementary operations (a real addition is 1); larger arrays and matrices take
    /// [more](Type::work_factor).
    pub work: u32,
    /// True if a cycle may fault (integer overflow, division by zero).
    pub may_fault: bool,
}

/// An in-port.
#[derive(Clone, Copy, Debug)]
pub struct InPort {
    /// Registered name, `inFirst`.
    pub name: &'static str,
    /// What it accepts.
    pub ty: PortType,
    /// What happens when it is not connected.
    pub need: Need,
}

/// An out-port.
#[derive(Clone, Copy, Debug)]
pub struct OutPort {
    /// Registered name, `outValue`.
    pub name: &'static str,
    /// What it gives.
    pub ty: PortType,
    /// When it is present.
    pub presence: Presence,
}

/// The type of a port before sizes are known.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum PortType {
    /// One value.
    One(Scalar),
    /// An array; its length is that of the source (in-ports) or follows from [`PrimDesc::shape`] (out-ports).
    Array(Scalar),
    /// A matrix of reals; its shape is that of the source or follows from [`PrimDesc::shape`].
    Matrix,
}

/// How the lengths of array and matrix out-ports follow from inputs and parameters. [`PrimDesc::out_type`] applies it.
#[derive(Clone, Copy, Debug)]
pub enum Shape {
    /// There is no such port, or nothing to derive and to check.
    Fixed,
    /// As long as the integer parameter of this name says.
    Size(&'static str),
    /// As long as the array in-port of this index.
    Like(usize),
    /// As long as the array parameter of this name.
    LikeParam(&'static str),
    /// Worked out, and refused (`None`) where sizes or indices do not fit; also called where only single values come out.
    Of(fn(&ShapeArgs<'_>) -> Option<Type>),
}

/// What a shape may depend on.
#[derive(Clone, Copy, Debug)]
pub struct ShapeArgs<'a> {
    /// Types of the in-ports; `None` where nothing is connected and no parameter stands in.
    pub inputs: &'a [Option<Type>],
    /// Parameters in the order of [`PrimDesc::params`].
    pub params: &'a [Value],
}

impl ShapeArgs<'_> {
    /// A parameter that is a size or an index; `None` if it is missing, negative or too large.
    #[must_use]
    pub fn size(&self, param: usize) -> Option<u32> {
        self.params
            .get(param)?
            .as_int()
            .and_then(|v| u32::try_from(v).ok())
    }

    /// Length of an array input.
    #[must_use]
    pub fn len(&self, input: usize) -> Option<u32> {
        match self.inputs.get(input)? {
            Some(Type::Array(_, n)) => Some(*n),
            _ => None,
        }
    }

    /// Rows and columns of a matrix input.
    #[must_use]
    pub fn shape(&self, input: usize) -> Option<(u32, u32)> {
        match self.inputs.get(input)? {
            Some(Type::Matrix(rows, cols)) => Some((*rows, *cols)),
            _ => None,
        }
    }
}

/// What an in-port does when nothing is connected.
#[derive(Clone, Copy, Debug)]
pub enum Need {
    /// The net is refused.
    Required,
    /// The parameter of this name, or else this default, stands in.
    Param(&'static str, Default),
    /// A value made of several real parameters stands in: their names with defaults, and how it is made of them.
    Params(&'static [(&'static str, f64)], fn(&[f64]) -> Value),
    /// It counts as absent.
    Absent,
}

/// A default that can stand in a constant.
#[derive(Clone, Copy, Debug)]
pub enum Default {
    /// The type's neutral value ([`Value::neutral`]).
    Neutral,
    /// A Boolean.
    Bool(bool),
    /// An integer.
    Int(i64),
    /// A real.
    Real(f64),
    /// A text.
    Str(&'static str),
    /// There is none: the parameter must be given.
    Required,
}

impl Default {
    /// The value that stands in for a parameter of type `ty`, if there is one.
    #[must_use]
    pub fn value(self, ty: Type) -> Option<Value> {
        Some(match self {
            Default::Neutral => Value::neutral(ty),
            Default::Bool(v) => Value::bool(v),
            Default::Int(v) => Value::int(v),
            Default::Real(v) => Value::real(v),
            Default::Str(v) => Value::Str(v.into()),
            Default::Required => return None,
        })
    }
}

/// A parameter, fixed at load.
#[derive(Clone, Copy, Debug)]
pub struct Param {
    /// Registered name, `Duration`.
    pub name: &'static str,
    /// Its type.
    pub ty: ParamType,
    /// Its default.
    pub default: Default,
}

/// The type of a parameter.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ParamType {
    /// A single value.
    One(Scalar),
    /// An array literal of any length.
    Array(Scalar),
    /// A text.
    Str,
}

/// When an output is present, as far as it follows from the inputs.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Presence {
    /// Present exactly if every connected input is. The primitive's code never sees absence:
    /// it has only a `total` form, and one with state is not run in a cycle in which an input is absent.
    Strict,
    /// The code decides; surely present if all connected inputs are (Kleene `and`, conditional).
    IfAll,
    /// The code decides; surely present if any input is (`??`).
    IfAny,
    /// The code decides; always present.
    Always,
    /// The code decides; may be absent although all inputs are present (`pre`, set-null).
    Maybe,
}

/// Memory kept from cycle to cycle, in cells. Zero is the initial content unless `init` says otherwise.
#[derive(Clone, Copy, Debug)]
pub enum State {
    /// None.
    None,
    /// A fixed number of cells. Operand: one word, the first cell.
    Cells(u32),
    /// As many cells as the parameters and the period ask for. Operands: two words, first cell and length.
    Sized(fn(&SizeArgs<'_>) -> u32),
}

/// What the size of a state may depend on.
#[derive(Clone, Copy, Debug)]
pub struct SizeArgs<'a> {
    /// Parameters in the order of [`PrimDesc::params`].
    pub params: &'a [Value],
    /// Period in seconds.
    pub dt: f64,
}

impl SizeArgs<'_> {
    /// Number of cycles that a real parameter spans, given in seconds: rounded up, at least 0, saturating.
    #[must_use]
    pub fn cycles(&self, param: usize) -> u32 {
        let span = self.params.get(param).and_then(Value::as_real);
        let cycles = span.unwrap_or(0.0) / self.dt;
        let whole = cycles as u32;
        whole.saturating_add(u32::from(cycles > f64::from(whole)))
    }
}

/// How the core treats a primitive.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Role {
    /// It has code that is run in dependency order.
    Compute,
    /// Its output is its parameter `Value`: folded when the net is lowered.
    Constant,
    /// `pre`: its output is its first input of the previous active cycle, absence included; absent at first. Latched in the commit phase.
    Delay,
    /// True exactly if the input is absent; an alias of the presence cell.
    IsAbsent,
    /// True exactly in the first cycle in which its fragment is active (after a restart again).
    First,
    /// Its outputs are read from a device before evaluation; it is read even inside an inactive fragment.
    Sensor(DeviceUse),
    /// It hands its inputs, one after the other as cells of one value, to a device: checked in dependency order, delivered in the write phase.
    /// Its out-ports are the device's answers ([`DeviceUse::answers`]).
    Actuator(DeviceUse),
    /// It calls a function of a device (kinematics) in dependency order, with its inputs one after the other as arguments and its
    /// out-ports one after the other as result.
    /// Where the device has no result, an output that is `Maybe` is absent and a `Strict` one is not a number.
    DeviceFunction(DeviceUse),
    /// Its output is set from outside between cycles, by key.
    Input,
    /// Its input is published after the cycle, by key.
    Export,
    /// A flow that the core provides.
    Flow(CommandFlow),
}

/// Which device port a primitive stands for; its parameters say which device.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct DeviceUse {
    /// Parameter that names the device.
    pub device: &'static str,
    /// Parameter that holds the index (axis, input number), if there are several equal ports.
    pub index: Option<&'static str>,
    /// The device's ports: one per out-port for a sensor, one for an actuator or a function.
    pub ports: DevicePorts,
    /// What an actuator's out-ports tell, one per out-port; empty for a sensor or a function.
    pub answers: &'static [Answer],
}

/// What an out-port of an actuator tells about the set-point handed over in this cycle.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Answer {
    /// True if another writer has set the port in the same cycle.
    ConcurrentAccess,
    /// True if the device has failed.
    DeviceFailed,
    /// True if the value is not reachable, out of limits or not a number.
    IllegalValue,
    /// The device's error code (int), 0 if it is well.
    ErrorCode,
    /// True once the device has taken the value over: it is well and has accepted it in the previous cycle.
    Completed,
}

/// Names of device ports.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum DevicePorts {
    /// Fixed by the primitive.
    Fixed(&'static [&'static str]),
    /// Given by the text parameter of this name.
    Param(&'static str),
}

/// The flows that the core provides to a command.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum CommandFlow {
    /// True from the first cycle after a cancel request on.
    Cancel,
    /// True if a successor is scheduled that covers every actuator which may be moving.
    Takeover,
    /// Seconds since the command's first cycle (real).
    Time,
    /// Period in seconds (real).
    Period,
    /// Logical time of the cycle ([`Scalar::Time`]).
    NetTime,
    /// The clock at evaluation ([`Scalar::Time`]).
    WallTime,
    /// Identity of the predecessor's result (int), absent without one.
    Predecessor,
    /// Ticks since the command's first cycle (int).
    Elapsed,
    /// Ticks in a period (int).
    PeriodTicks,
}

impl PrimDesc {
    /// Index of an in-port by registered name.
    #[must_use]
    pub fn input(&self, name: &str) -> Option<usize> {
        self.inputs.iter().position(|p| p.name == name)
    }

    /// Index of an out-port by registered name.
    #[must_use]
    pub fn output(&self, name: &str) -> Option<usize> {
        self.outputs.iter().position(|p| p.name == name)
    }

    /// Index of a parameter by registered name.
    #[must_use]
    pub fn param(&self, name: &str) -> Option<usize> {
        self.params.iter().position(|p| p.name == name)
    }

    /// Index of the in-port for which the parameter `name` stands in, alone or with others.
    #[must_use]
    pub fn fallback(&self, name: &str) -> Option<usize> {
        self.inputs.iter().position(|p| match p.need {
            Need::Param(n, _) => n == name,
            Need::Params(names, _) => names.iter().any(|(n, _)| *n == name),
            Need::Required | Need::Absent => false,
        })
    }

    /// Type of an out-port once the types of the in-ports and the parameters are known; `None` if they do not fit.
    #[must_use]
    pub fn out_type(&self, port: usize, args: &ShapeArgs<'_>) -> Option<Type> {
        if let Shape::Of(of) = self.shape {
            return of(args);
        }
        match self.outputs.get(port)?.ty {
            PortType::One(s) => Some(Type::One(s)),
            PortType::Array(s) => self.out_len(args).map(|n| Type::Array(s, n)),
            PortType::Matrix => None,
        }
    }

    fn out_len(&self, args: &ShapeArgs<'_>) -> Option<u32> {
        match self.shape {
            Shape::Fixed | Shape::Of(_) => None,
            Shape::Size(name) => args.size(self.param(name)?),
            Shape::Like(input) => args.len(input),
            Shape::LikeParam(name) => match args.params.get(self.param(name)?)?.ty()? {
                Type::Array(_, n) => Some(n),
                _ => None,
            },
        }
    }
}
