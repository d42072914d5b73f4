//! C variables of the slots.

use crate::access::step_accesses;
use crate::c_type::CType;
use crate::identifiers::Names;
use crate::literals::literal;
use crate::ports::Interface;
use crate::scopes::Lifetime;
use crate::slots::{Region, Slots};
use rpi_image::image::{Image, SlotRange};
use std::collections::{BTreeMap, BTreeSet};

/// Maximum number of statements of a function with local variables. A larger image is distributed over functions, which
/// share a struct of values: the time that C compilers take is not proportional to the size of a function.
pub(crate) const MAX_STATEMENTS: usize = 2000;

/// Place in which a C variable is stored.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Storage {
    /// Field of the input struct.
    Input,
    /// Field of the state struct.
    State,
    /// Variable of the cycle: local, or a field of the struct of values.
    Cycle,
    /// Local variable that is declared where it is written.
    Scope,
}

/// C variable: a single value, or an array of adjacent slots.
#[derive(Clone, Debug)]
pub(crate) struct Variable {
    pub(crate) name: String,
    pub(crate) ty: CType,
    pub(crate) slots: SlotRange,
    pub(crate) storage: Storage,
}

/// All C variables of an image.
pub(crate) struct Variables {
    by_slot: BTreeMap<u32, Variable>,
    /// True if the values of a cycle are fields of a struct.
    pub(crate) has_struct: bool,
}

impl Variables {
    pub(crate) fn new(image: &Image, slots: &Slots, interface: &Interface) -> Variables {
        let mut variables = Variables {
            by_slot: BTreeMap::new(),
            has_struct: statements(image) > MAX_STATEMENTS,
        };
        let mut names = Names::default();
        let whole = whole_writes(image, slots);
        let layout = image.layout;
        for object in slots.objects(layout.constants, layout.end) {
            if !slots.is_used(object) && interface.object(object.start).is_none() {
                continue;
            }
            let storage = variables.storage(slots, object, &whole);
            let field = interface.object(object.start);
            let name = match (storage, field) {
                (Storage::Input, Some(field)) => field.to_owned(),
                _ => names.unique(&source_name(image, object.start)),
            };
            // Flows that are computed from the number of the cycle are external slots without a field.
            let storage = match (storage, field) {
                (Storage::Input, None) => Storage::Cycle,
                (storage, _) => storage,
            };
            let variable = Variable {
                name,
                ty: slots.ty(object.start),
                slots: object,
                storage,
            };
            variables.by_slot.insert(object.start, variable);
        }
        variables
    }

    fn storage(&self, slots: &Slots, object: SlotRange, whole: &BTreeSet<u32>) -> Storage {
        match slots.region(object.start) {
            Region::External => return Storage::Input,
            Region::State => return Storage::State,
            Region::Constant | Region::Value => {}
        }
        let lifetimes = (object.start..object.end()).map(|slot| slots.lifetime(slot));
        let declared = whole.contains(&object.start) && !self.has_struct;
        match lifetimes.max() {
            Some(Lifetime::Permanent) => Storage::State,
            Some(Lifetime::Scope | Lifetime::Unread) if declared => Storage::Scope,
            _ => Storage::Cycle,
        }
    }

    /// Returns the variable that contains a slot; `None` for a constant.
    pub(crate) fn of(&self, slot: u32) -> Option<&Variable> {
        let (_, variable) = self.by_slot.range(..=slot).next_back()?;
        (slot < variable.slots.end()).then_some(variable)
    }

    /// Returns all variables in one kind of storage.
    pub(crate) fn in_storage(&self, storage: Storage) -> impl Iterator<Item = &Variable> {
        self.by_slot.values().filter(move |v| v.storage == storage)
    }

    /// Returns the C expression that names a variable.
    pub(crate) fn path(&self, variable: &Variable) -> String {
        let name = &variable.name;
        match variable.storage {
            Storage::Input => format!("in->{name}"),
            Storage::State => format!("s->{name}"),
            Storage::Cycle if self.has_struct => format!("v->{name}"),
            Storage::Cycle | Storage::Scope => name.clone(),
        }
    }

    /// Returns the C expression for a slot as a place or as a value of its own type.
    pub(crate) fn slot(&self, slots: &Slots, slot: u32) -> String {
        match self.of(slot) {
            None => literal(slots.initial(slot), slots.ty(slot)),
            Some(variable) if variable.slots.len == 1 => self.path(variable),
            Some(variable) => {
                let index = slot - variable.slots.start;
                format!("{}[{index}]", self.path(variable))
            }
        }
    }

    /// Returns the C expression for the value of a slot as type `ty`.
    pub(crate) fn value(&self, slots: &Slots, slot: u32, ty: CType) -> String {
        let Some(variable) = self.of(slot) else {
            return literal(slots.initial(slot), ty);
        };
        convert(&self.slot(slots, slot), variable.ty, ty)
    }

    /// Returns the C expression for a pointer to a slot.
    pub(crate) fn pointer(&self, slots: &Slots, slot: u32) -> String {
        match self.of(slot) {
            Some(variable) if variable.slots.len > 1 => match slot - variable.slots.start {
                0 => self.path(variable),
                index => format!("{} + {index}", self.path(variable)),
            },
            _ => format!("&{}", self.slot(slots, slot)),
        }
    }
}

/// Returns the C expression `text` of type `from` with the same bits as type `to`.
pub(crate) fn convert(text: &str, from: CType, to: CType) -> String {
    match (from, to) {
        (from, to) if from == to => text.to_owned(),
        (CType::Word, CType::Real) => format!("rpi_real({text})"),
        (CType::Word, CType::Int) => format!("rpi_integer({text})"),
        (_, CType::Bool) => format!("({text} != 0)"),
        (CType::Bool, CType::Word) => format!("({text} ? 1U : 0U)"),
        (CType::Bool, CType::Int) => format!("({text} ? 1 : 0)"),
        (CType::Bool, CType::Real) => format!("rpi_real({text} ? 1U : 0U)"),
        (CType::Int, CType::Real) => format!("rpi_real((uint64_t){text})"),
        (CType::Real, CType::Int) => format!("rpi_integer(rpi_bits({text}))"),
        (CType::Real, CType::Word) => format!("rpi_bits({text})"),
        (_, CType::Word) => format!("(uint64_t){text}"),
        (_, to) => format!("({}){text}", to.name()),
    }
}

/// Returns the number of statements of the evaluation phase.
fn statements(image: &Image) -> usize {
    let steps = image.steps.iter();
    steps
        .map(|step| step_accesses(image, step).len().max(1) / 3 + 1)
        .sum()
}

/// Returns the first slots of the objects that one step writes completely.
fn whole_writes(image: &Image, slots: &Slots) -> BTreeSet<u32> {
    let mut whole = BTreeSet::new();
    for step in &image.steps {
        let accesses = step_accesses(image, step);
        let writes = accesses.iter().filter(|a| a.writes);
        let objects = writes.filter(|a| slots.object(a.slots.start) == a.slots);
        // Results of a device function are written slot by slot, from a buffer.
        let declares = matches!(step, rpi_image::Step::Run { .. });
        whole.extend(objects.filter(|_| declares).map(|a| a.slots.start));
    }
    whole
}

/// Returns a name for a slot: that of the flow in the source, else the end of the path of its node.
fn source_name(image: &Image, slot: u32) -> String {
    let Some(location) = image.location_of(slot) else {
        return format!("t{slot}");
    };
    let path = location.path.rsplit('/').next().unwrap_or("");
    let name = location.flow.as_deref().unwrap_or(path);
    match name.is_empty() {
        true => format!("t{slot}"),
        false => name.to_owned(),
    }
}
