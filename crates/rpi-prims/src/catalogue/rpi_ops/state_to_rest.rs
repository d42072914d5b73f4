//! Motion of an axis from any state to rest at a goal that may change.

use crate::context::{Context, FaultCode};
use crate::macros::primitive;
use crate::registry::Prim;
use rpi_kin::state_to_rest::{AxisState, Bounds, StateToRestProfile};

pub(in crate::catalogue) const ALL: &[Prim] = &[REACH];

primitive! {
    /// Motion of an axis from any state of motion to rest at `inGoal` in the shortest time with bounded velocity,
    /// acceleration and jerk, among motions that have no acceleration at their maximum velocity (double-S profile;
    /// Biagiotti and Melchiorri, Trajectory Planning for Automatic Machines and Robots, 2008, 3.4). Units are rad or m,
    /// and s. The initial state is read in the first cycle; velocity and acceleration are backward differences of
    /// set-points, as reported by devices. The first output is one period later. Goal and bounds may change in any
    /// cycle; the motion is then planned again from its own last set-points. Backward differences of the outputs keep
    /// the bounds if those of the initial state do. `outDone` is true from the cycle after the goal is reached. Bounds
    /// that are not positive are a fault. Inputs that are not finite give not-a-number.
    REACH = "Rpi::Reach";
    in {
        inPosition: f64;
        inVelocity: f64 = Velocity(Real(0.0));
        inAcceleration: f64 = Acceleration(Real(0.0));
        inGoal: f64;
        inMaxVelocity: f64 = MaxVelocity(Real(1.0));
        inMaxAcceleration: f64 = MaxAcceleration(Real(2.0));
        inMaxJerk: f64 = MaxJerk(Real(20.0))
    }
    out { outPosition: f64; outVelocity: f64; outAcceleration: f64; outDone: bool }
    state { [f64; SLOTS] }
    presence strict work 120 faults;
    full |cx, place, (cells,), _, (position, velocity, acceleration, goal, speed, most_acceleration, jerk)| {
        let bounds = Bounds { speed, acceleration: most_acceleration, jerk };
        let start = AxisState { position, velocity, acceleration };
        if !bounds.are_positive() {
            cx.fault(FaultCode::AssertionFailed, place);
        }
        let mut memory = Memory::from_slots(cells);
        let done = memory.step(cx, start, goal, bounds);
        *cells = memory.to_slots();
        let AxisState { position, velocity, acceleration } = memory.at;
        (position, velocity, acceleration, done)
    }
}

/// Number of stored values: cycle, state, bounds and profile.
const SLOTS: usize = HEAD + StateToRestProfile::LEN;
const HEAD: usize = 7;

struct Memory {
    /// Number of cycles on this profile; 0 before the first cycle.
    cycle: f64,
    /// Last set-point with its backward differences.
    at: AxisState,
    bounds: Bounds,
    way: StateToRestProfile,
}

impl Memory {
    fn from_slots(cells: &[f64; SLOTS]) -> Memory {
        let [
            cycle,
            position,
            velocity,
            acceleration,
            speed,
            most,
            jerk,
            rest @ ..,
        ] = *cells;
        Memory {
            cycle,
            at: AxisState {
                position,
                velocity,
                acceleration,
            },
            bounds: Bounds {
                speed,
                acceleration: most,
                jerk,
            },
            way: StateToRestProfile::from_array(&rest),
        }
    }

    fn to_slots(&self) -> [f64; SLOTS] {
        let mut cells = [0.0; SLOTS];
        let (head, rest) = cells.split_at_mut(HEAD);
        head.copy_from_slice(&[
            self.cycle,
            self.at.position,
            self.at.velocity,
            self.at.acceleration,
            self.bounds.speed,
            self.bounds.acceleration,
            self.bounds.jerk,
        ]);
        rest.copy_from_slice(&self.way.to_array());
        cells
    }

    /// Advances by one period. Returns whether the goal was reached before this cycle.
    fn step(&mut self, cx: &Context<'_>, start: AxisState, goal: f64, bounds: Bounds) -> bool {
        let dt = cx.time.dt;
        if self.cycle == 0.0 {
            self.at = start;
        }
        // Exact comparison on purpose: any change of goal or bounds needs a new plan.
        if self.cycle == 0.0 || self.way.goal() != goal || self.bounds != bounds {
            let Some(way) = StateToRestProfile::from_differences(self.at, dt, goal, bounds) else {
                self.at.position = f64::NAN;
                return false;
            };
            (self.way, self.bounds, self.cycle) = (way, bounds, 0.0);
        }
        let done = self.cycle > 0.0 && self.cycle * dt >= self.way.duration();
        self.cycle += 1.0;
        let position = self.way.state_at(self.cycle * dt).position;
        let velocity = (position - self.at.position) / dt;
        self.at = AxisState {
            position,
            velocity,
            acceleration: (velocity - self.at.velocity) / dt,
        };
        done
    }
}
