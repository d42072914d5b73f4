//! Images of single primitives: each in-port is an input of the image, each out-port an export.

use rpi_image::hash::prim_signature;
use rpi_image::image::{
    Export, Fragment, InputPort, Layout, PrimUse, Signal, SlotRange, Step, TRUE,
};
use rpi_image::{
    Form, Image, ParamType, PortType, Scalar, ShapeArgs, SizeArgs, StateSize, Type, Value,
};
use rpi_prims::Prim;

/// Period in ns.
const PERIOD_NS: u64 = 10_000_000;

/// Region of the memory of an image.
#[derive(Clone, Copy)]
enum Region {
    Constant,
    External,
    State,
    Value,
}

/// Word of an operand: a number, or a slot in a region, which is placed when all regions are known.
#[derive(Clone, Copy)]
enum Word {
    Number(u32),
    Slot(Region, u32),
}

/// Builder of an image.
#[derive(Default)]
pub(crate) struct ImageBuilder {
    image: Image,
    words: Vec<Word>,
    inputs: Vec<(String, Type, u32, Option<u32>)>,
    exports: Vec<(String, Type, u32, Option<u32>)>,
    constants: Vec<u64>,
    state: Vec<u64>,
    external: u32,
    values: u32,
}

impl ImageBuilder {
    pub(crate) fn new() -> ImageBuilder {
        ImageBuilder {
            constants: vec![0, 1],
            ..ImageBuilder::default()
        }
    }

    /// Appends a call of a primitive with default parameters, arrays of length 3 and matrices of 3 by 3.
    pub(crate) fn call(&mut self, prim: &Prim, form: Form) {
        let params = params(prim);
        let types: Vec<Type> = prim.desc.inputs.iter().map(|p| sized(p.ty)).collect();
        let start = self.words.len();
        for (port, ty) in prim.desc.inputs.iter().zip(&types) {
            self.input(&format!("{}.{}", prim.desc.name, port.name), *ty, form);
        }
        for value in params.iter().filter(|v| v.ty().is_some()) {
            let at = self.constants.len() as u32;
            self.constants.extend_from_slice(value.slots());
            self.words.push(Word::Slot(Region::Constant, at));
            self.sizes(value.ty());
        }
        let inputs: Vec<Option<Type>> = types.iter().copied().map(Some).collect();
        let args = ShapeArgs {
            inputs: &inputs,
            params: &params,
        };
        for (k, port) in prim.desc.outputs.iter().enumerate() {
            let ty = prim.desc.out_type(k, &args).expect("sizes fit");
            self.export(&format!("{}.{}", prim.desc.name, port.name), ty, form);
        }
        self.state(prim, &params);
        let known = self
            .image
            .prims_used
            .iter()
            .position(|p| p.name == prim.desc.name);
        let number = known.unwrap_or(self.image.prims_used.len());
        if known.is_none() {
            self.image.prims_used.push(PrimUse {
                name: prim.desc.name.to_owned(),
                signature: prim_signature(&prim.desc),
            });
        }
        self.image.steps.push(Step::Run {
            prim: number as u16,
            form,
            start: start as u32,
            len: (self.words.len() - start) as u32,
        });
    }

    fn sizes(&mut self, ty: Option<Type>) {
        match ty {
            Some(Type::Array(_, n)) => self.words.push(Word::Number(n)),
            Some(Type::Matrix(r, c)) => self.words.extend([r, c].map(Word::Number)),
            _ => {}
        }
    }

    fn input(&mut self, name: &str, ty: Type, form: Form) {
        let at = self.external;
        self.external += ty.slots();
        self.words.push(Word::Slot(Region::External, at));
        self.sizes(Some(ty));
        let present = (form == Form::Optional).then_some(self.external);
        if let Some(present) = present {
            self.external += 1;
            self.words.push(Word::Slot(Region::External, present));
        }
        self.inputs.push((format!("{name}{at}"), ty, at, present));
    }

    fn export(&mut self, name: &str, ty: Type, form: Form) {
        let at = self.values;
        self.values += ty.slots();
        self.words.push(Word::Slot(Region::Value, at));
        self.sizes(Some(ty));
        let present = (form == Form::Optional).then_some(self.values);
        if let Some(present) = present {
            self.values += 1;
            self.words.push(Word::Slot(Region::Value, present));
        }
        self.exports.push((format!("{name}{at}"), ty, at, present));
    }

    fn state(&mut self, prim: &Prim, params: &[Value]) {
        let args = SizeArgs {
            params,
            dt: PERIOD_NS as f64 / 1e9,
        };
        let len = match prim.desc.state {
            StateSize::None | StateSize::Fixed(0) => return,
            StateSize::Fixed(n) => n,
            StateSize::Computed(size) => size(&args),
        };
        let at = self.state.len();
        self.state.resize(at + len as usize, 0);
        if let Some(init) = prim.init {
            init(&args, &mut self.state[at..]);
        }
        self.words.push(Word::Slot(Region::State, at as u32));
        if matches!(prim.desc.state, StateSize::Computed(_)) {
            self.words.push(Word::Number(len));
        }
    }

    /// Places the regions and returns the image.
    pub(crate) fn finish(self) -> Image {
        let constants = self.constants.len() as u32;
        let external = constants + self.external;
        let state = external + self.state.len() as u32;
        let layout = Layout {
            constants,
            external,
            state,
            end: state + self.values,
        };
        let place = |word: &Word| match *word {
            Word::Number(n) => n,
            Word::Slot(Region::Constant, k) => k,
            Word::Slot(Region::External, k) => constants + k,
            Word::Slot(Region::State, k) => external + k,
            Word::Slot(Region::Value, k) => state + k,
        };
        let signal = |base: u32, ty: Type, at: u32, present: Option<u32>| Signal {
            start: base + at,
            present: present.map_or(TRUE, |p| base + p),
            ty,
        };
        let mut image = self.image;
        image.name = "Primitives".to_owned();
        (image.period_ns, image.tick_ns) = (PERIOD_NS, PERIOD_NS);
        image.layout = layout;
        let initial = (0..).zip(&self.constants).map(|(k, bits)| (k, *bits));
        let states = (external..).zip(&self.state).map(|(k, bits)| (k, *bits));
        image.init = initial.chain(states).filter(|slot| slot.1 != 0).collect();
        image.code = self.words.iter().map(place).collect();
        image.fragments = vec![Fragment {
            path: String::new(),
            parent: None,
            active: TRUE,
            state: SlotRange {
                start: external,
                len: state - external,
            },
        }];
        let inputs = self.inputs.into_iter();
        let input = |(key, ty, at, present)| InputPort {
            key,
            unit: String::new(),
            value: signal(constants, ty, at, present),
            last_updated: None,
        };
        image.inputs = inputs.map(input).collect();
        let exports = self.exports.into_iter();
        let export = |(key, ty, at, present)| Export {
            key,
            unit: String::new(),
            value: signal(state, ty, at, present),
        };
        image.exports = exports.map(export).collect();
        image
    }
}

fn sized(ty: PortType) -> Type {
    match ty {
        PortType::Scalar(s) => Type::Scalar(s),
        PortType::Array(s) => Type::Array(s, 3),
        PortType::Matrix => Type::Matrix(3, 3),
    }
}

fn params(prim: &Prim) -> Vec<Value> {
    let one = |p: &rpi_image::Param| match p.ty {
        ParamType::Str => Value::Str(String::new()),
        // Windows of many cycles would stay half empty.
        ParamType::Scalar(Scalar::Real) if p.name == "Duration" || p.name == "MaxAge" => {
            Value::real(0.07)
        }
        ParamType::Scalar(s) => p.default.value(s.into()).expect("a default"),
        ParamType::Array(s) => Value::neutral(Type::Array(s, 0)),
    };
    prim.desc.params.iter().map(one).collect()
}
