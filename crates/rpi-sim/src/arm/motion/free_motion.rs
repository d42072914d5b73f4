//! Beginning of motions that have no path of their own: of the axes, and of the tool with a velocity.

use super::Motion;
use super::call::Request;
use crate::arm::axes_motion::AxesMotionKind;
use crate::arm::jog::Jog;
use crate::arm::path_fault::PathFault;
use crate::error_code::ErrorCode;
use rpi_motion::JointState;
use rpi_motion::path::TwistFrame;

impl Motion {
    /// Begins a motion of the axes without a path.
    pub(super) fn start_axes(
        &mut self,
        kind: AxesMotionKind,
        request: &Request<'_>,
        state: &JointState,
    ) -> Result<(), PathFault> {
        let (target, requested) = (request.target, request.requested);
        let axes = &mut self.axes;
        axes.begin(&self.arm, kind, target, requested, state, self.period)?;
        self.way = axes.way();
        Ok(())
    }

    /// Begins a motion of the tool with a velocity.
    pub(super) fn start_jog(
        &mut self,
        frame: TwistFrame,
        request: &Request<'_>,
        state: &JointState,
        time: f64,
    ) -> Result<(), PathFault> {
        if !request.requested.are_positive() {
            return Err(ErrorCode::NOT_POSITIVE.into());
        }
        let jog = Jog::new(frame, request.target, time);
        match jog.path(&self.arm.forward(&state.position)) {
            Some(path) => self.follow(path, &state.position, request, state)?,
            None => self.hold(state),
        }
        self.jog = Some(jog);
        Ok(())
    }
}
