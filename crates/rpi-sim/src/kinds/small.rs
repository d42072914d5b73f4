//! The device of a small kind: ports, checks of set-points, watchdog and reports, which all small devices share.

use super::{BuildContext, Settings, SmallDevice};
use crate::arm::limits::Violation;
use crate::bank::CellDevice;
use crate::device::{
    Device, PortIndex, PortInfo, PortRow, PortSpec, Report, find_port, is_actuator, is_in_row,
    read_port, real_at,
};
use crate::error_code::ErrorCode;
use core::ops::Range;
use rpi_device::{PortKind, PortQuery, Rejection, ResolveError};
use rpi_image::Scalar;

/// Maximum number of reports that wait until they are read.
const REPORT_CAPACITY: usize = 16;

/// Small device of a simulated cell: the device `D`, with the checks, watchdog and reports that all small devices
/// share.
pub(super) struct Small<D> {
    device: D,
    time: f64,
    /// Number of ticks between two set-points of the running command.
    set_point_ticks: u32,
    /// Number of ticks until the next set-point is due.
    ticks_left: u32,
    /// Number of successive periods without a set-point so far.
    missed_periods: u32,
    /// Number of successive periods without a set-point after which the device brakes.
    watchdog_periods: u32,
    is_braking: bool,
    staged: Option<f64>,
    code: ErrorCode,
    reports: Vec<Report>,
    lost_reports: u64,
}

/// Ports for the error of a device, which follow the own ports of every small device with an actuator.
const STATUS_PORTS: &[PortRow<ErrorCode>] = &[
    PortRow::<ErrorCode>::sensor("error", Scalar::Bool, |code, _, out| {
        out.put_bits(u64::from(*code != ErrorCode::OK))
    })
    .means("true if the device reports an error"),
    PortRow::<ErrorCode>::sensor("code", Scalar::Int, |code, _, out| {
        out.put_bits(code.0.cast_unsigned())
    })
    .means("error code, 0 for no error"),
];

fn has_actuator<D: SmallDevice>() -> bool {
    let kinds = D::PORTS.iter().map(|row| row.spec.kind);
    kinds.into_iter().any(|kind| kind == PortKind::Actuator)
}

/// Returns all ports of a kind, each with its meaning, in the order of their rows.
fn specs<D: SmallDevice>() -> impl Iterator<Item = (&'static PortSpec, &'static str)> {
    let count = if has_actuator::<D>() {
        STATUS_PORTS.len()
    } else {
        0
    };
    let status = STATUS_PORTS.iter().take(count);
    let status = status.map(|row| (&row.spec, row.meaning));
    let own = D::PORTS.iter().map(|row| (&row.spec, row.meaning));
    own.chain(status)
}

/// Returns the descriptions of the ports of a kind, for the manual.
pub(super) fn ports<D: SmallDevice>() -> Vec<PortInfo> {
    let all = specs::<D>();
    all.map(|(spec, meaning)| PortInfo {
        meaning,
        ..spec.info()
    })
    .collect()
}

impl<D: SmallDevice> Small<D> {
    pub(super) fn new(settings: &Settings, context: &BuildContext) -> Self {
        Self {
            device: D::new(settings, context),
            time: 0.0,
            set_point_ticks: 1,
            ticks_left: 0,
            missed_periods: 0,
            watchdog_periods: settings.number(super::WATCHDOG.name) as u32,
            is_braking: false,
            staged: None,
            code: ErrorCode::OK,
            reports: Vec::with_capacity(REPORT_CAPACITY),
            lost_reports: 0,
        }
    }

    fn check_value(&self, port: PortIndex, value: &[u64]) -> Result<f64, Violation> {
        let set_point = real_at(value, 0);
        if !is_actuator(D::PORTS, port) {
            return Err(Violation::from_code(ErrorCode::INVALID_PARAMETER));
        }
        if !set_point.is_finite() {
            let code = ErrorCode::NOT_A_NUMBER;
            return Err(Violation {
                value: set_point,
                ..Violation::from_code(code)
            });
        }
        self.device.check(set_point).map(|()| set_point)
    }

    /// Sets the error code of the device, and reports it if it is new.
    fn set_error(&mut self, violation: Violation) {
        let Violation { code, value, limit } = violation;
        if code != self.code {
            let report = Report {
                time: self.time,
                axis: None,
                code,
                value,
                limit,
            };
            match self.reports.len() < REPORT_CAPACITY {
                true => self.reports.push(report),
                false => self.lost_reports += 1,
            }
        }
        self.code = code;
    }

    /// Counts a period without a set-point. The device brakes if the watchdog allows no further one.
    fn miss_set_point(&mut self) {
        self.missed_periods += 1;
        if self.missed_periods < self.watchdog_periods {
            self.ticks_left = self.set_point_ticks;
            return;
        }
        self.set_error(Violation::from_code(ErrorCode::SET_POINT_MISSING));
        self.is_braking = true;
        self.device.stop();
    }
}

impl<D: SmallDevice> CellDevice for Small<D> {}

impl<D: SmallDevice> Device for Small<D> {
    fn resolve(&self, name: &PortQuery<'_>) -> Result<PortIndex, ResolveError> {
        find_port(specs::<D>().map(|(spec, _)| spec), name, |_| 1)
    }

    fn has_port(&self, port: PortIndex) -> bool {
        let spec = specs::<D>().nth(usize::from(port.row));
        is_in_row(spec.map(|(spec, _)| spec), port, |_| 1)
    }

    fn resources(&self, port: PortIndex) -> Range<u32> {
        0..u32::from(is_actuator(D::PORTS, port))
    }

    fn read(&self, port: PortIndex, value: &mut [u64]) -> bool {
        match usize::from(port.row).checked_sub(D::PORTS.len()) {
            None => read_port(D::PORTS, &self.device, port, value),
            Some(row) => {
                let row = row as u16;
                read_port(STATUS_PORTS, &self.code, PortIndex { row, ..port }, value)
            }
        }
    }

    fn check(&mut self, port: PortIndex, value: &[u64]) -> Rejection {
        match self.check_value(port, value) {
            Ok(_) => {
                self.code = ErrorCode::OK;
                Rejection::NONE
            }
            Err(violation) => {
                self.set_error(violation);
                Rejection::ILLEGAL_VALUE
            }
        }
    }

    fn port_code(&self, _port: PortIndex) -> ErrorCode {
        self.code
    }

    fn write(&mut self, port: PortIndex, value: &[u64]) {
        self.staged = self.check_value(port, value).ok().or(self.staged);
    }

    fn is_moving(&self, _resource: u32) -> bool {
        self.device.is_moving()
    }

    fn stop(&mut self, _resource: u32) {
        self.staged = None;
        self.is_braking = self.device.is_moving();
        self.device.stop();
    }

    fn begin_command(&mut self, _resource: u32, ticks: u32) {
        self.set_point_ticks = ticks.max(1);
        self.code = ErrorCode::OK;
    }

    fn step(&mut self, time: f64) {
        self.time = time;
        if let Some(set_point) = self.staged.take() {
            self.device.set(set_point);
            self.ticks_left = self.set_point_ticks;
            (self.missed_periods, self.is_braking) = (0, false);
        } else if D::IS_WATCHED
            && self.ticks_left == 0
            && self.device.is_moving()
            && !self.is_braking
        {
            self.miss_set_point();
        }
        self.ticks_left = self.ticks_left.saturating_sub(1);
        self.device.step(time);
    }

    fn code(&self) -> ErrorCode {
        self.code
    }

    fn reports(&mut self, each: &mut dyn FnMut(Report)) -> u64 {
        self.reports.drain(..).for_each(each);
        core::mem::take(&mut self.lost_reports)
    }
}
