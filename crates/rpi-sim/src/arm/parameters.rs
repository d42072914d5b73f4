//! Parameters of an arm that programs set through ports: control strategy, tool load, impedances.

use super::port_table::Parameter;
use rpi_kin::MAX_AXES;

/// Number of stored parameters: tool load, impedance and sinusoidal force at the tool, and the impedance of each joint.
const PARAMETERS: usize = 3 + MAX_AXES;
/// Maximum number of reals of a parameter.
const LARGEST_PARAMETER: usize = 18;

/// Number of the control strategy "position control" in the numbering of the KUKA LWR. 20 and 30 are Cartesian and
/// joint impedance.
const POSITION_CONTROL: i64 = 10;

/// Positions, in a value of the port `tool_and_tcp`, of the ten numbers of [`Arm::load`]. The value consists of mass,
/// centre of mass as a pose, moments of inertia, and tool centre point as a pose; of the poses, only the positions are
/// used.
const LOAD_INDICES: [usize; 10] = [0, 1, 2, 3, 8, 9, 10, 11, 12, 13];

/// Latest values of the parameters that programs set, such as the tool load. They have no effect on the simulated
/// motion.
#[derive(Clone, Debug)]
pub(super) struct Parameters {
    values: [[f64; LARGEST_PARAMETER]; PARAMETERS],
    /// Control strategy that the command requested: 10 for position control, 20 for Cartesian impedance, 30 for joint
    /// impedance.
    pub(super) strategy: i64,
}

impl Parameters {
    pub(super) fn new() -> Self {
        Self {
            values: [[0.0; LARGEST_PARAMETER]; PARAMETERS],
            strategy: POSITION_CONTROL,
        }
    }

    /// Stores the value of a parameter, given as slots. `index` is the axis if each axis has its own value.
    pub(super) fn store(&mut self, parameter: Parameter, index: usize, value: &[u64]) {
        if let Parameter::Strategy = parameter {
            self.strategy = value
                .first()
                .map_or(self.strategy, |bits| bits.cast_signed());
            return;
        }
        if let Some(kept) = self.values.get_mut(resource_index(parameter, index)) {
            for (k, slot) in kept.iter_mut().enumerate() {
                let k = match parameter {
                    Parameter::ToolAndTcp => LOAD_INDICES.get(k).copied(),
                    _ => Some(k),
                };
                let bits = k.and_then(|k| value.get(k));
                *slot = bits.map_or(*slot, |bits| f64::from_bits(*bits));
            }
        }
    }

    /// Returns the tool load that was requested last; see [`super::Arm::load`].
    pub(super) fn load(&self) -> &[f64] {
        &self.values[resource_index(Parameter::Tool, 0)][..10]
    }
}

/// True if an arm accepts this value of a parameter: finite numbers, no negative mass, a known control strategy.
pub(super) fn accepts(parameter: Parameter, value: &[u64]) -> bool {
    let first = value.first().copied().unwrap_or_default();
    let finite = value.iter().all(|bits| f64::from_bits(*bits).is_finite());
    match parameter {
        Parameter::Strategy => matches!(first, 10 | 20 | 30),
        Parameter::Tool | Parameter::ToolAndTcp => finite && f64::from_bits(first) >= 0.0,
        _ => finite,
    }
}

/// Returns the index of a parameter among the stored ones; also its resource number, counted after those of the axes.
pub(super) fn resource_index(parameter: Parameter, index: usize) -> usize {
    match parameter {
        Parameter::Tool | Parameter::ToolAndTcp => 0,
        Parameter::ToolImpedance => 1,
        Parameter::ToolSine => 2,
        Parameter::JointImpedance => 3 + index,
        Parameter::Strategy => PARAMETERS,
    }
}
