//! Declarations of primitives: names, ports, parameters, state and role. The type checker, the importer, hover texts,
//! the generated reference, the lowering and the loader read them; the code of a primitive is in `rpi-prims`.

use crate::types::{Scalar, Type};
use crate::value::Value;

// All fields are `'static` or `fn` pointers, so that a declaration is a `const` and the registry is built at compile
// time.
/// The declaration of one primitive.
#[derive(Clone, Copy, Debug)]
pub struct PrimDesc {
    /// Registered name, for example `Core::DoubleAdd`.
    pub name: &'static str,
    /// Documentation: the operation, units, frames and source.
    pub doc: &'static str,
    /// In-ports in declaration order.
    pub inputs: &'static [InPort],
    /// Out-ports in declaration order.
    pub outputs: &'static [OutPort],
    /// Parameters in declaration order, without those that replace an unconnected in-port (see [`InPort::fallback`]).
    pub params: &'static [Param],
    /// Rule for the lengths of array out-ports and the shapes of matrix out-ports.
    pub shape: ShapeRule,
    /// State kept from cycle to cycle.
    pub state: StateSize,
    /// Way in which the core handles the primitive: as code, or as an interface to devices, inputs or the core itself.
    pub role: Role,
    /// Upper bound of the work in one cycle, in elementary operations (the addition of two reals is 1). Larger arrays
    /// and matrices multiply it by [`Type::work_factor`].
    pub work: u32,
    /// Whether a cycle may raise a fault (integer overflow, division by zero).
    pub may_fault: bool,
}

/// In-port of a primitive: name, accepted type, and behaviour without a connection.
#[derive(Clone, Copy, Debug)]
pub struct InPort {
    /// Registered name, for example `inFirst`.
    pub name: &'static str,
    /// Accepted type.
    pub ty: PortType,
    /// Behaviour if the port is not connected.
    pub fallback: Fallback,
}

/// Out-port of a primitive: name and type.
#[derive(Clone, Copy, Debug)]
pub struct OutPort {
    /// Registered name, for example `outValue`.
    pub name: &'static str,
    /// Type of the output.
    pub ty: PortType,
    /// Rule for the presence of the output.
    pub presence: Presence,
}

/// Type that a primitive declares for a port, before array lengths and matrix shapes are known.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum PortType {
    /// Single value.
    Scalar(Scalar),
    /// Array. The length of an in-port is that of its source; the length of an out-port follows from
    /// [`PrimDesc::shape`].
    Array(Scalar),
    /// Matrix of reals. The shape of an in-port is that of its source; the shape of an out-port follows from
    /// [`PrimDesc::shape`].
    Matrix,
}

/// Rule that derives the lengths of array out-ports and the shapes of matrix out-ports from inputs and parameters.
/// [`PrimDesc::out_type`] applies it.
#[derive(Clone, Copy, Debug)]
pub enum ShapeRule {
    /// No array or matrix out-port, and no size to check.
    Fixed,
    /// Length equal to the integer parameter with this name.
    FromParam(&'static str),
    /// Length equal to that of the array in-port with this index.
    SameAsInput(usize),
    /// Length equal to that of the array parameter with this name.
    SameAsParam(&'static str),
    /// Type computed by a function; `None` if sizes or indices do not fit. The function is also called for single
    /// outputs, to check sizes.
    Computed(fn(&ShapeArgs<'_>) -> Option<Type>),
}

/// Arguments of a shape rule ([`ShapeRule`]).
#[derive(Clone, Copy, Debug)]
pub struct ShapeArgs<'a> {
    /// Types of the in-ports; `None` for a port that is neither connected nor replaced by a parameter.
    pub inputs: &'a [Option<Type>],
    /// Values of the parameters, in the order of [`PrimDesc::params`].
    pub params: &'a [Value],
}

impl ShapeArgs<'_> {
    /// Returns the parameter with index `param` as a size or an index; `None` if it is missing, negative or above
    /// `u32::MAX`.
    #[must_use]
    pub fn size(&self, param: usize) -> Option<u32> {
        self.params
            .get(param)?
            .as_int()
            .and_then(|v| u32::try_from(v).ok())
    }

    /// Returns the length of the array in-port with index `input`; `None` if it is not an array.
    #[must_use]
    pub fn len(&self, input: usize) -> Option<u32> {
        match self.inputs.get(input)? {
            Some(Type::Array(_, n)) => Some(*n),
            _ => None,
        }
    }

    /// Returns the numbers of rows and columns of the matrix in-port with index `input`; `None` if it is not a matrix.
    #[must_use]
    pub fn shape(&self, input: usize) -> Option<(u32, u32)> {
        match self.inputs.get(input)? {
            Some(Type::Matrix(rows, cols)) => Some((*rows, *cols)),
            _ => None,
        }
    }
}

/// Behaviour of an in-port that is not connected.
#[derive(Clone, Copy, Debug)]
pub enum Fallback {
    /// The port must be connected; otherwise the net is rejected.
    Required,
    /// The parameter with this name replaces the connection; the second field is the default of the parameter.
    Param(&'static str, ParamDefault),
    /// A value computed from several real parameters replaces the connection. The fields are the names and defaults of
    /// the parameters, and the function that computes the value.
    ComposedOfParams(&'static [(&'static str, f64)], fn(&[f64]) -> Value),
    /// The port counts as absent.
    AbsentValue,
}

/// Default of a parameter, in a form that is allowed in a `const`.
#[derive(Clone, Copy, Debug)]
pub enum ParamDefault {
    /// The value 0, false or empty of the parameter's type, see [`Value::neutral`].
    Neutral,
    /// Boolean default.
    Bool(bool),
    /// Integer default.
    Int(i64),
    /// Real default.
    Real(f64),
    /// Text default.
    Str(&'static str),
    /// No default: the parameter must be set.
    Required,
}

impl ParamDefault {
    /// Returns the default of a parameter of type `ty`; `None` for [`ParamDefault::Required`].
    #[must_use]
    pub fn value(self, ty: Type) -> Option<Value> {
        Some(match self {
            ParamDefault::Neutral => Value::neutral(ty),
            ParamDefault::Bool(v) => Value::bool(v),
            ParamDefault::Int(v) => Value::int(v),
            ParamDefault::Real(v) => Value::real(v),
            ParamDefault::Str(v) => Value::Str(v.into()),
            ParamDefault::Required => return None,
        })
    }
}

/// Parameter of a primitive: a constant, fixed when the command is loaded.
#[derive(Clone, Copy, Debug)]
pub struct Param {
    /// Registered name, for example `Duration`.
    pub name: &'static str,
    /// Type that an argument for the parameter must have.
    pub ty: ParamType,
    /// Value of the parameter in nets that do not set it.
    pub default: ParamDefault,
}

/// Type of a parameter of a primitive, whose value is fixed when the net is loaded.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ParamType {
    /// Single value.
    Scalar(Scalar),
    /// Array literal of any length.
    Array(Scalar),
    /// Text.
    Str,
}

/// Presence of an output, as far as it follows from the presence of the inputs.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Presence {
    /// Present exactly if every connected input is present. The code of the primitive never handles absence: it has
    /// only a `total` form, and a primitive with state does not run in a cycle in which an input is absent.
    Strict,
    /// Always present if all connected inputs are present (Kleene `and`, conditional); otherwise the code of the
    /// primitive decides.
    IfAll,
    /// Always present if at least one input is present (`??`); otherwise the code of the primitive decides.
    IfAny,
    /// Always present, even if inputs are absent.
    Always,
    /// May be absent even if all inputs are present (`pre`, set-null): the code of the primitive decides.
    Maybe,
}

/// State kept from cycle to cycle, in slots of 64 bits. The initial content is zero unless the primitive has an `init`
/// function.
#[derive(Clone, Copy, Debug)]
pub enum StateSize {
    /// No state.
    None,
    /// Fixed number of slots. The operand is one word: the first slot.
    Fixed(u32),
    /// Number of slots computed from the parameters and the period. The operand is two words: the first slot and the
    /// length.
    Computed(fn(&SizeArgs<'_>) -> u32),
}

/// Arguments of the function that computes the size of a state ([`StateSize::Computed`]).
#[derive(Clone, Copy, Debug)]
pub struct SizeArgs<'a> {
    /// Values of the parameters, in the order of [`PrimDesc::params`].
    pub params: &'a [Value],
    /// Period of the command, s.
    pub dt: f64,
}

impl SizeArgs<'_> {
    /// Returns the number of cycles that the real parameter with index `param` spans. The parameter is in seconds. The
    /// result is rounded up and saturates at 0 and `u32::MAX`.
    #[must_use]
    pub fn cycles_of_param(&self, param: usize) -> u32 {
        let span = self.params.get(param).and_then(Value::as_real);
        let cycles = span.unwrap_or(0.0) / self.dt;
        let whole = cycles as u32;
        whole.saturating_add(u32::from(cycles > f64::from(whole)))
    }
}

/// Handling of a primitive by the core.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Role {
    /// Computes the outputs from the inputs by the code of the primitive, in dependency order.
    Compute,
    /// Outputs the parameter `Value`. It is folded when the net is lowered.
    Constant,
    /// `pre`: outputs the first input of the previous active cycle, absence included. The output is absent in the first
    /// cycle. The value is latched in the commit phase.
    Delay,
    /// Outputs true exactly if the input is absent. It is an alias of the presence slot.
    IsAbsent,
    /// Outputs true exactly in the first cycle in which the enclosing fragment is active, and again after each reset.
    First,
    /// Outputs values read from a device before evaluation. The device is read even if the enclosing fragment is
    /// inactive.
    Sensor(DeviceUse),
    /// Passes its inputs to a device as one set-point, concatenated slot by slot. The set-point is checked in
    /// dependency order and delivered in the write phase. The out-ports are the responses of the device
    /// ([`DeviceUse::responses`]).
    Actuator(DeviceUse),
    /// Calls a function of a device (kinematics) in dependency order. The inputs are concatenated to the arguments, the
    /// out-ports to the result. If the device has no result, an output with [`Presence::Maybe`] is absent, and one with
    /// [`Presence::Strict`] is not a number.
    DeviceFunction(DeviceUse),
    /// Outputs a value that is set by key from outside, between cycles.
    Input,
    /// Publishes the value of the input under a key after the cycle.
    Export,
    /// Outputs a flow that the core provides, such as the time or a cancel request.
    Flow(CommandFlow),
}

/// Device port that a primitive uses. Parameters of the primitive select the device.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct DeviceUse {
    /// Name of the parameter that holds the name of the device.
    pub device: &'static str,
    /// Name of the parameter that holds the index (axis, input number), if the device has several equal ports.
    pub index: Option<&'static str>,
    /// Ports of the device: one per out-port for a sensor, exactly one for an actuator or a function.
    pub ports: DevicePortNames,
    /// Meaning of each out-port of an actuator; empty for a sensor or a function.
    pub responses: &'static [DeviceResponse],
}

/// Response of a device to the set-point of this cycle, as an out-port of an actuator.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum DeviceResponse {
    /// True if another writer has set the port in the same cycle.
    ConcurrentAccess,
    /// True if the device has failed.
    DeviceFailed,
    /// True if the value is unreachable, outside its limits or not a number.
    IllegalValue,
    /// Error code of the device (int); 0 if there is no error.
    ErrorCode,
    /// True if the device has accepted the set-point of the previous cycle and has no error.
    Completed,
}

/// Names of device ports used by a primitive.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum DevicePortNames {
    /// Names that are the same in every use of the primitive.
    Fixed(&'static [&'static str]),
    /// Name held by the text parameter with this name.
    Param(&'static str),
}

/// Flow that the core provides to a command.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum CommandFlow {
    /// True from the first cycle after a cancel request.
    Cancel,
    /// True if a successor is scheduled that covers every resource that may be moving.
    Takeover,
    /// Time since the first cycle of the command, s (real).
    Time,
    /// Period of the command, s (real).
    Period,
    /// Logical time of the cycle ([`Scalar::Time`]).
    NetTime,
    /// Time of the system clock at evaluation ([`Scalar::Time`]).
    WallTime,
    /// Identity of the result of the preceding command ([`crate::hash::result_id`], int); absent if there is no
    /// preceding command.
    Predecessor,
    /// Time since the first cycle of the command, in ticks (int).
    Elapsed,
    /// Period of the command, in ticks (int).
    PeriodTicks,
    /// Share of the speed at which all motions go, from 0 to 1 (real); the operator sets it for the whole core.
    SpeedOverride,
    /// True while the operator pauses all motions.
    Pause,
}

impl PrimDesc {
    /// Returns the index of the in-port with this registered name.
    #[must_use]
    pub fn input(&self, name: &str) -> Option<usize> {
        self.inputs.iter().position(|p| p.name == name)
    }

    /// Returns the index of the out-port with this registered name.
    #[must_use]
    pub fn output(&self, name: &str) -> Option<usize> {
        self.outputs.iter().position(|p| p.name == name)
    }

    /// Returns the index of the parameter with this registered name.
    #[must_use]
    pub fn param(&self, name: &str) -> Option<usize> {
        self.params.iter().position(|p| p.name == name)
    }

    /// Returns the index of the in-port that the parameter `name` replaces if it is not connected.
    #[must_use]
    pub fn in_port_of_param(&self, name: &str) -> Option<usize> {
        self.inputs.iter().position(|p| match p.fallback {
            Fallback::Param(n, _) => n == name,
            Fallback::ComposedOfParams(names, _) => names.iter().any(|(n, _)| *n == name),
            Fallback::Required | Fallback::AbsentValue => false,
        })
    }

    /// Returns the type of the out-port with index `port` for the given in-port types and parameters; `None` if they do
    /// not fit.
    #[must_use]
    pub fn out_type(&self, port: usize, args: &ShapeArgs<'_>) -> Option<Type> {
        if let ShapeRule::Computed(of) = self.shape {
            return of(args);
        }
        match self.outputs.get(port)?.ty {
            PortType::Scalar(s) => Some(Type::Scalar(s)),
            PortType::Array(s) => self.derived_len(args).map(|n| Type::Array(s, n)),
            PortType::Matrix => None,
        }
    }

    fn derived_len(&self, args: &ShapeArgs<'_>) -> Option<u32> {
        match self.shape {
            ShapeRule::Fixed | ShapeRule::Computed(_) => None,
            ShapeRule::FromParam(name) => args.size(self.param(name)?),
            ShapeRule::SameAsInput(input) => args.len(input),
            ShapeRule::SameAsParam(name) => match args.params.get(self.param(name)?)?.ty()? {
                Type::Array(_, n) => Some(n),
                _ => None,
            },
        }
    }
}
