//! Types of values. A device is not one: it is a parameter whose ports have values.

use super::body::Body;
use super::report::not_a;
use crate::program::{DeclId, DeclKind, Lookup, Space};
use crate::ty::Ty;
use rpi_diag::Span;
use rpi_syntax::ast::{Type, TypeKind};

impl<'a> Body<'_, 'a> {
    /// Resolves the type of a value; reports a device.
    pub(super) fn value_ty(&mut self, ty: &'a Type) -> Ty {
        // Recognised by its name alone: the declaration of the device may need this very type.
        if let Some(device) = self.named_device(ty) {
            let declared = self.c.program.decl(device);
            return self.device_as_value(&declared.name, ty.span, declared.span);
        }
        match self.ty(ty) {
            Ty::Device(device) => self.device_as_value(&device.name, ty.span, Span::NONE),
            ty => ty,
        }
    }

    fn device_as_value(&mut self, name: &str, at: Span, declared: Span) -> Ty {
        let finding = not_a("a type of values", name, "a device", at, declared);
        self.report(finding.help(HELP));
        Ty::Unknown
    }

    fn named_device(&self, ty: &Type) -> Option<DeclId> {
        let TypeKind::Named(named) = &ty.kind else {
            return None;
        };
        let name = &named.name.name;
        match self.c.program.lookup_in(Space::Type, self.module, name) {
            Lookup::Found(id) if !self.statics.contains_key(name) => {
                let kind = self.c.program.decl(id).kind;
                matches!(kind, DeclKind::Device(_)).then_some(id)
            }
            _ => None,
        }
    }
}

const HELP: &str =
    "declare a device as a parameter of a command, fragment or node: `command C (arm: Arm)`";
