//! Lowering of fragments: scopes that are skipped as a whole, and their restarts.

use super::Builder;
use crate::flat_net::{ScopeId, index};
use crate::registers::{Region, Register};
use rpi_image::image::{self, SlotRange};
use rpi_net::{AbsentPolicy, Activation, FragmentId, Net, PortRef, Restart};

/// Scopes and activation registers of all fragments, by fragment index. The entry of a fragment that is not built yet
/// is the root scope and the constant true.
pub(super) struct FragmentScopes {
    /// For each fragment, the scope that contains its operations.
    scopes: Vec<ScopeId>,
    /// For each fragment, the Boolean register that says whether it is active, provided that its parent is.
    active: Vec<Register>,
    /// For each fragment, how many of the parts into which the schedule divides it have been built so far.
    entry_counts: Vec<u32>,
}

impl FragmentScopes {
    pub(super) fn new(fragments: usize) -> Self {
        FragmentScopes {
            scopes: vec![ScopeId::ROOT; fragments],
            active: vec![Register::TRUE; fragments],
            entry_counts: vec![0; fragments],
        }
    }

    pub(super) fn scope(&self, fragment: FragmentId) -> ScopeId {
        self.scopes[fragment.index()]
    }

    /// Returns the Boolean register that says whether a fragment is active, provided that its parent is.
    pub(super) fn active(&self, fragment: FragmentId) -> Register {
        self.active[fragment.index()]
    }

    fn was_entered(&self, fragment: FragmentId) -> bool {
        self.entry_counts[fragment.index()] > 0
    }

    /// Counts one more part of a fragment that the schedule enters. Returns the number of parts before it.
    pub(super) fn count_entry(&mut self, fragment: FragmentId) -> usize {
        let count = &mut self.entry_counts[fragment.index()];
        *count += 1;
        *count as usize - 1
    }
}

/// Returns the fragment table of the image, one entry per fragment of the net. At first, each fragment counts as always
/// active and has no state; building and emission fill in both.
pub(super) fn fragment_table(net: &Net) -> Vec<image::Fragment> {
    let entry = |id: FragmentId| {
        let fragment = net.fragment(id);
        let parent = fragment.parent;
        image::Fragment {
            path: parent.map_or(String::new(), |p| net.path(p, &fragment.name)),
            parent: parent.map(|p| p.0),
            active: Register::TRUE.0,
            state: SlotRange::default(),
        }
    };
    net.fragment_ids().map(entry).collect()
}

impl Builder<'_> {
    pub(super) fn fragment(&mut self, id: FragmentId) {
        let net = self.net;
        let fragment = net.fragment(id);
        let Some(parent) = fragment.parent else {
            return;
        };
        let is_again = self.fragments.was_entered(id);
        let active = match is_again {
            true => self.fragments.active(id),
            false => self.activity(id, parent),
        };
        self.fragments.active[id.index()] = active;
        self.flat.tables.fragments[id.index()].active = active.0;
        if active == Register::TRUE && fragment.restart == Restart::Never {
            self.fragments.scopes[id.index()] = self.fragments.scope(parent);
            return self.items(id);
        }
        let scope = self.flat.open(self.fragments.scope(parent), active);
        self.fragments.scopes[id.index()] = scope;
        // The schedule may enter a fragment several times in a cycle; only the first entry may reset it.
        if !is_again {
            self.restart(id, parent, scope);
        }
        self.items(id);
        self.flat.close(scope);
    }

    /// Returns the Boolean register that is true while a fragment is active, provided that its parent is. Adds the
    /// operations that compute it to the scope of the parent.
    fn activity(&mut self, id: FragmentId, parent: FragmentId) -> Register {
        let net = self.net;
        let Activation::When {
            condition,
            if_absent: absent,
        } = net.fragment(id).activation
        else {
            return Register::TRUE;
        };
        let flow = self.seen_from(condition, parent).flow;
        let scope = self.fragments.scope(parent);
        match absent {
            AbsentPolicy::Inactive => {
                self.logic
                    .and(&mut self.flat, scope, flow.value, flow.present)
            }
            AbsentPolicy::Active => {
                let missing = self.logic.not(&mut self.flat, scope, flow.present);
                self.logic.or(&mut self.flat, scope, flow.value, missing)
            }
        }
    }

    fn restart(&mut self, id: FragmentId, parent: FragmentId, scope: ScopeId) {
        let unless = match self.net.fragment(id).restart {
            Restart::Never => return,
            Restart::OnActivation => self.was_active(id, parent),
            Restart::Every(condition) => self.restart_not_requested(condition, parent, scope),
        };
        self.flat.scopes[scope.index()].reset = Some((unless, index(id.index())));
    }

    /// Returns a new register that is true if the fragment was active in the last cycle in which its parent was. The
    /// register is part of the parent's state, so that a pause of the parent does not end the activation of the child.
    fn was_active(&mut self, id: FragmentId, parent: FragmentId) -> Register {
        let was = self.flat.registers.add(Region::State(parent), 1);
        let active = self.fragments.active(id);
        let outer = self.fragments.scope(parent);
        self.flat.scopes[outer.index()].latches.push((active, was));
        was
    }

    /// Returns a Boolean register that is true unless the restart condition of a fragment is present and true. Adds the
    /// operations that compute it around `scope`, which is the scope of the fragment.
    fn restart_not_requested(
        &mut self,
        condition: PortRef,
        parent: FragmentId,
        scope: ScopeId,
    ) -> Register {
        let flow = self.seen_from(condition, parent).flow;
        let outer = self.flat.scopes[scope.index()]
            .parent
            .unwrap_or(ScopeId::ROOT);
        let requested = self
            .logic
            .and(&mut self.flat, outer, flow.value, flow.present);
        self.logic.not(&mut self.flat, outer, requested)
    }

    /// Adds the copies at the end of the cycle that store the inputs of all delays for the next cycle.
    pub(super) fn latches(&mut self) {
        for (id, kept) in std::mem::take(&mut self.delays) {
            let link = self.link(id, 0);
            let scope = self.scope_of(id);
            let latches = &mut self.flat.scopes[scope.index()].latches;
            latches.push((link.flow.value, kept.value));
            if kept.present != Register::TRUE {
                latches.push((link.flow.present, kept.present));
            }
        }
    }
}
