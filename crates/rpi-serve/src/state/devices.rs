//! Devices: those of the cell, and simulated ones that clients add and remove while commands run.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use rpi_core::{Command, LoadError};
use rpi_image::Image;
use rpi_sim::cell::DeviceSpec;
use rpi_sim::{Cell, NamedDevice};

use super::bank;
use super::commands::Commands;
use super::device_spec::{NewDevice, device_info, device_spec, kind_name};
use super::event_log::EventLog;
use super::loader::DeviceReplica;
use super::subscribers::Subscribers;
use super::types::{ApiError, DeviceInfo, Subscriber, Update};
use crate::fair_share::Usage;
use crate::limits::Limits;
use crate::peer::Peer;

/// Table of the devices by slot (index in the core's device table), with the subscribers to changes and a copy of the
/// devices, with which the loader resolves names.
pub(crate) struct Devices {
    slots: Vec<Option<DeviceInfo>>,
    /// For each slot, the peer of the client that added the device; `None` for devices of the cell and slots that were
    /// never used. A device outlives the connection of its client.
    makers: Vec<Option<Peer>>,
    pub(super) subscribers: Subscribers,
    replica: Arc<Mutex<DeviceReplica>>,
    seed: u64,
    /// Number of devices of the cell, which have the first slots. Clients cannot remove them.
    cell_count: usize,
    /// Length of a tick in seconds.
    tick: f64,
    /// Maximum length of a device name in bytes.
    longest: usize,
}

/// Name of the limit on the number of devices, for messages.
const DEVICE_LIMIT: &str = "devices";

/// Characters that are not allowed in a device name, because protocols and pages use them as delimiters.
const FORBIDDEN_CHARS: &[char] = &['"', '\\', '<', '>'];

impl Devices {
    /// Creates the table with the devices of a cell and empty slots for devices that clients add.
    pub(super) fn from_cell(cell: &Cell, limits: &Limits, tick_ns: u64) -> Devices {
        let infos = cell
            .devices
            .iter()
            .map(|spec| Some(device_info(spec, kind_name(&spec.kind))));
        let mut places: Vec<Option<DeviceInfo>> = infos.collect();
        places.resize(limits.devices.max(places.len()), None);
        Devices {
            makers: vec![None; places.len()],
            slots: places,
            subscribers: Subscribers::default(),
            replica: Arc::new(Mutex::new(DeviceReplica {
                bank: bank(cell, limits.devices, tick_ns),
                generation: 0,
            })),
            seed: cell.seed,
            cell_count: cell.devices.len(),
            tick: tick_ns as f64 * 1e-9,
            longest: limits.name_bytes,
        }
    }

    /// Returns the copy of the devices, with which the loader resolves names.
    pub(super) fn replica(&self) -> Arc<Mutex<DeviceReplica>> {
        Arc::clone(&self.replica)
    }

    fn lock_replica(&self) -> MutexGuard<'_, DeviceReplica> {
        self.replica.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns the number of changes of the devices since the server started. A changed number means that resolved
    /// device names may be wrong.
    pub(super) fn generation(&self) -> u64 {
        self.lock_replica().generation
    }

    /// Loads a command from its image, with its device names resolved to the current devices. Returns all errors if it
    /// cannot be loaded.
    pub(super) fn load(&self, image: &Arc<Image>) -> Result<Command, Vec<LoadError>> {
        Command::load(Arc::clone(image), &mut self.lock_replica().bank)
    }

    /// Returns the descriptions of all devices, in the order of their slots.
    pub(crate) fn all(&self) -> impl Iterator<Item = &DeviceInfo> {
        self.slots.iter().flatten()
    }

    /// Returns whether any device moves.
    pub(super) fn any_moving(&self) -> bool {
        self.all().any(|info| info.moving)
    }

    /// Returns the name of the device to which an actuator belongs. The upper 16 bits of the resource number `resource`
    /// are the slot of the device.
    pub(super) fn device_name(&self, resource: u32) -> String {
        let info = self.slots.get((resource >> 16) as usize);
        let info = info.and_then(Option::as_ref);
        info.map_or_else(|| "a device".to_owned(), |info| info.name.clone())
    }

    /// Returns the display name of an actuator: the device's name and the index of the actuator in the device, as in
    /// `arm[2]`.
    pub(super) fn actuator_name(&self, resource: u32) -> String {
        format!("{}[{}]", self.device_name(resource), resource & 0xffff)
    }

    /// Subscribes to all devices: reports each of them now, and changes later.
    pub(crate) fn watch(&mut self, mut sink: Box<dyn Subscriber>) {
        if self
            .all()
            .all(|info| sink.notify(&Update::DeviceAdded(info)))
        {
            self.subscribers.push(sink);
        }
    }

    /// Returns whether a device of the requested name and type exists already.
    ///
    /// # Errors
    /// If the name is not allowed or belongs to a device of another type.
    pub(super) fn is_inserted(&self, new: &NewDevice<'_>) -> Result<bool, ApiError> {
        let Some(place) = self.find(new.name) else {
            return self.ensure_valid_name(new.name).map(|()| false);
        };
        let info = self.slots[place].as_ref();
        match info.is_some_and(|i| i.kind == new.kind) {
            true => Ok(true),
            false => Err(ApiError::Invalid(format!(
                "a device {} of another type exists already",
                new.name
            ))),
        }
    }

    /// Returns an error if the text is not allowed as a device name. The name is shown unescaped in pages, messages and
    /// the log.
    fn ensure_valid_name(&self, name: &str) -> Result<(), ApiError> {
        if name.len() > self.longest {
            return Err(ApiError::Limit("bytes of a name"));
        }
        let is_bad = |c: char| c.is_control() || FORBIDDEN_CHARS.contains(&c);
        match name.trim().is_empty() || name.contains(is_bad) {
            true => Err(ApiError::Invalid(format!(
                "{name:?} is not a device name: it must not be blank or contain line breaks, quotes, `\\`, `<` or `>`"
            ))),
            false => Ok(()),
        }
    }

    /// Adds a simulated device to the table. Returns its slot, the device for the cycle and its description for
    /// clients.
    pub(super) fn add(
        &mut self,
        new: &NewDevice<'_>,
    ) -> Result<(usize, NamedDevice, DeviceInfo), ApiError> {
        let spec = device_spec(new, self.tick)?;
        let place = self.free_slot(new.peer)?;
        self.makers[place] = Some(new.peer);
        // Two equal devices: one for the cycle, one for resolving names outside of it.
        let device = self.create_device(&spec, place);
        self.change_replica(place, Some(self.create_device(&spec, place)));
        let info = device_info(&spec, new.kind);
        self.slots[place] = Some(info.clone());
        Ok((place, device, info))
    }

    fn create_device(&self, spec: &DeviceSpec, place: usize) -> NamedDevice {
        NamedDevice::new(spec, self.tick, self.seed, place)
    }

    /// Empties the slot with this index.
    pub(super) fn clear(&mut self, place: usize) {
        self.change_replica(place, None);
        self.slots[place] = None;
    }

    fn change_replica(&mut self, place: usize, device: Option<NamedDevice>) {
        let mut replica = self.lock_replica();
        replica.bank.swap(place, device);
        replica.generation += 1;
    }

    /// Returns the index of a free slot for a device that a client of this peer adds, or an error if all slots or the
    /// share of the peer are used up.
    fn free_slot(&self, peer: Peer) -> Result<usize, ApiError> {
        let made = self.slots.iter().zip(&self.makers).skip(self.cell_count);
        let made = made.filter(|(device, _)| device.is_some());
        let own = made.clone().filter(|(_, maker)| **maker == Some(peer));
        let taken = Usage::for_peer(made.count(), own.count());
        let room = taken.admit(1, self.slots.len() - self.cell_count);
        room.map_err(|full| ApiError::limit(full, DEVICE_LIMIT))?;
        let free = self.slots.iter().position(Option::is_none);
        free.ok_or(ApiError::Limit(DEVICE_LIMIT))
    }

    fn find(&self, name: &str) -> Option<usize> {
        let is = |info: &Option<DeviceInfo>| info.as_ref().is_some_and(|i| i.name == name);
        self.slots.iter().position(is)
    }

    /// Returns the slot of the device with this name, and the numbers of the ended commands that used the device.
    /// Returns an error if the device is unknown, belongs to the cell, or is used by a command that has not ended.
    pub(super) fn removable(
        &self,
        name: &str,
        commands: &Commands,
    ) -> Result<(usize, Vec<u64>), ApiError> {
        let unknown = || ApiError::Unknown(format!("device {name}"));
        let place = self.find(name).ok_or_else(unknown)?;
        if place < self.cell_count {
            return Err(ApiError::InUse(format!(
                "device {name} belongs to the cell"
            )));
        }
        let users = commands.iter().filter(|(_, r)| r.uses(name));
        let (ended, holding): (Vec<_>, Vec<_>) = users.partition(|(_, r)| r.has_ended());
        match holding.first() {
            Some((number, record)) => Err(ApiError::InUse(format!(
                "device {name} is held by n{number} ({}): unload it first",
                record.title
            ))),
            None => Ok((place, ended.into_iter().map(|(number, _)| number).collect())),
        }
    }

    /// Handles the answer that the cycle has added a device: notifies the subscribers. Returns the name of the device.
    pub(super) fn on_added(&mut self, info: DeviceInfo, log: &mut EventLog) -> String {
        self.subscribers.notify(&Update::DeviceAdded(&info));
        log.write(format_args!("device {} was added", info.name));
        info.name
    }

    /// Handles the event that the error code (0 if there is no error) of the device in a slot has changed, or that the
    /// device has started or stopped moving.
    pub(super) fn on_changed(&mut self, place: usize, code: i64, moving: bool, log: &mut EventLog) {
        let Some(Some(info)) = self.slots.get_mut(place) else {
            return;
        };
        info.moving = moving;
        if std::mem::replace(&mut info.code, code) != code {
            let name = &info.name;
            self.subscribers
                .notify(&Update::DeviceCondition(name, code));
            let how = rpi_sim::error_code::ErrorCode(code);
            log.write(format_args!("device {name}: {how}"));
        }
    }

    /// Handles the answer that the cycle has removed the device with this name: notifies the subscribers.
    pub(super) fn on_removed(&mut self, name: &str, log: &mut EventLog) {
        self.subscribers.notify(&Update::DeviceRemoved(name));
        log.write(format_args!("device {name} was removed"));
    }
}
