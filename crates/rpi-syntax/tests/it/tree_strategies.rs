//! Strategies for syntax trees without source.

use proptest::prelude::*;
use rpi_syntax::Dialect;
use rpi_syntax::ast::*;
use rpi_syntax::ops::{BINARY, BinaryOp, UNARY, UnaryOp};

/// Generates plain names, including predeclared ones.
fn name() -> impl Strategy<Value = Name> {
    const NAMES: &[&str] = &[
        "x",
        "y'",
        "_",
        "arm",
        "speed",
        "none",
        "time",
        "code",
        "sum_of_all_forces",
    ];
    prop::sample::select(NAMES).prop_map(Name::from)
}

/// Generates binary operators.
fn binary() -> impl Strategy<Value = BinaryOp> {
    let ops = BINARY.iter().filter(|row| !row.only_lustre);
    prop::sample::select(ops.map(|row| row.op).collect::<Vec<_>>())
}

/// Generates all unary operators except `last`, whose operand must be a name.
fn unary() -> impl Strategy<Value = UnaryOp> {
    let ops = UNARY
        .iter()
        .filter(|row| !row.only_lustre)
        .map(|row| row.op)
        .filter(|op| *op != UnaryOp::Last);
    prop::sample::select(ops.collect::<Vec<_>>())
}

/// Generates identifiers.
fn ident() -> impl Strategy<Value = Ident> {
    name().prop_map(Ident::synthetic)
}

/// Generates numbers.
fn number() -> impl Strategy<Value = Number> {
    prop_oneof![
        any::<u32>().prop_map(|value| Number::from_int(value.into())),
        (0.0..1e300f64).prop_map(|value| Number::from_real(value).expect("finite")),
        prop::sample::select(&["0x1F", "1.", ".5e-3", "0"][..])
            .prop_map(|text| Number { text: text.into() }),
    ]
}

/// Generates units.
fn unit() -> impl Strategy<Value = Unit> {
    let factor = (
        prop::sample::select(&["m", "s", "kg", "%", "deg"][..]),
        prop::sample::select(&[-3, -1, 1, 2][..]),
    );
    prop::collection::vec(factor, 0..4).prop_map(Unit::synthetic)
}

/// Generates expressions without operands.
fn leaf() -> impl Strategy<Value = Expr> {
    prop_oneof![
        any::<bool>().prop_map(Expr::bool),
        number().prop_map(|number| ExprKind::Number(number).into()),
        (number(), unit()).prop_map(|(number, unit)| ExprKind::Quantity(Box::new(Quantity {
            number,
            unit
        }))
        .into()),
        "[ -~ä\n\t]{0,8}".prop_map(Expr::str),
        name().prop_map(Expr::name),
        Just(Expr::name("Core::Pi")),
    ]
}

/// Generates expressions.
fn expr() -> BoxedStrategy<Expr> {
    let tree = leaf().prop_recursive(6, 60, 4, |inner| {
        prop_oneof![
            (binary(), inner.clone(), inner.clone()).prop_map(|(op, a, b)| Expr::binary(op, a, b)),
            (unary(), inner.clone()).prop_map(|(op, a)| Expr::unary(op, a)),
            name().prop_map(|flow| Expr::unary(UnaryOp::Last, Expr::name(flow))),
            (inner.clone(), clock())
                .prop_map(
                    |(value, clock)| ExprKind::When(Box::new(WhenExpr { value, clock })).into()
                ),
            conditional(inner.clone()),
            (inner.clone(), name()).prop_map(|(base, field)| base.field(field)),
            (inner.clone(), inner.clone()).prop_map(|(base, index)| base.index(index)),
            (inner.clone(), slice(inner.clone())).prop_map(|(base, slice)| {
                ExprKind::Slice(Box::new(SliceExpr { base, slice })).into()
            }),
            call(inner.clone()),
            prop::collection::vec(inner.clone(), 1..4)
                .prop_map(|xs| ExprKind::Array(xs.into()).into()),
            prop::collection::vec(inner.clone(), 2..4)
                .prop_map(|xs| ExprKind::Tuple(xs.into()).into()),
            prop::collection::vec(inner.clone(), 1..4).prop_map(|xs| ExprKind::BoolList(
                BoolListOp::Nor,
                xs.into()
            )
            .into()),
            merge(inner.clone()),
            struct_value(inner.clone()),
            update(inner),
        ]
    });
    tree.boxed()
}

/// Generates `if c then x else y`, or `with` instead of `if`.
fn conditional(inner: impl Strategy<Value = Expr> + Clone) -> impl Strategy<Value = Expr> {
    (any::<bool>(), inner.clone(), inner.clone(), inner.clone()).prop_map(
        |(is_static, condition, yes, no)| {
            ExprKind::If(Box::new(IfExpr {
                is_static,
                condition,
                then_value: yes,
                else_value: no,
            }))
            .into()
        },
    )
}

/// Generates a call.
fn call(inner: impl Strategy<Value = Expr> + Clone) -> impl Strategy<Value = Expr> {
    (
        callee(inner.clone()),
        activation(inner.clone()),
        args(inner.clone()),
    )
        .prop_map(|(callee, activation, args)| {
            ExprKind::Call(Box::new(Call {
                callee,
                activation,
                args,
            }))
            .into()
        })
}

/// Generates `merge c (...)`.
fn merge(inner: impl Strategy<Value = Expr> + Clone) -> impl Strategy<Value = Expr> {
    (
        name(),
        prop::collection::vec((ident(), inner.clone()), 1..3),
    )
        .prop_map(|(on, cases)| {
            let cases = cases
                .into_iter()
                .map(|(value, then)| MergeCase { value, then })
                .collect();
            ExprKind::Merge(Box::new(Merge {
                selector: Expr::name(on),
                cases,
            }))
            .into()
        })
}

/// Generates `T{f = x}`.
fn struct_value(inner: impl Strategy<Value = Expr> + Clone) -> impl Strategy<Value = Expr> {
    (
        ident(),
        prop::collection::vec((ident(), inner.clone()), 0..3),
    )
        .prop_map(|(ty, fields)| {
            let fields = fields
                .into_iter()
                .map(|(field, value)| FieldValue { field, value })
                .collect();
            ExprKind::Struct(Box::new(StructExpr {
                ty,
                statics: Vec::new(),
                base: None,
                fields,
            }))
            .into()
        })
}

/// Generates `(x with .f = y)`.
fn update(inner: impl Strategy<Value = Expr> + Clone) -> impl Strategy<Value = Expr> {
    (
        inner.clone(),
        prop::collection::vec((path(inner.clone()), inner), 1..3),
    )
        .prop_map(|(base, changes)| {
            let changes = changes
                .into_iter()
                .map(|(path, value)| Change { path, value })
                .collect();
            ExprKind::Update(Box::new(Update {
                base,
                changes,
                is_keyed: false,
            }))
            .into()
        })
}

/// Generates clocks.
fn clock() -> impl Strategy<Value = Clock> {
    let tick = prop_oneof![
        Just(ClockValue::True),
        Just(ClockValue::False),
        ident().prop_map(ClockValue::Value)
    ];
    (tick, ident()).prop_map(|(tick, flow)| Clock {
        value: tick,
        flow,
        span: rpi_diag::Span::NONE,
    })
}

/// Generates bounds of slices.
fn slice(inner: impl Strategy<Value = Expr> + Clone) -> impl Strategy<Value = SliceBounds> {
    (inner.clone(), inner.clone(), prop::option::of(inner))
        .prop_map(|(from, to, step)| SliceBounds { from, to, step })
}

/// Generates paths to a part of a value.
fn path(inner: impl Strategy<Value = Expr> + Clone) -> impl Strategy<Value = Vec<Access>> {
    let step = prop_oneof![
        ident().prop_map(Access::Field),
        inner.clone().prop_map(Access::Index),
        slice(inner).prop_map(|slice| Access::Slice(Box::new(slice))),
    ];
    prop::collection::vec(step, 1..3)
}

/// Generates callees with static arguments.
fn callee(inner: impl Strategy<Value = Expr> + Clone) -> impl Strategy<Value = Callee> {
    let op = prop_oneof![binary().prop_map(StaticOp::Binary), Just(StaticOp::If),];
    let value = prop_oneof![
        inner.prop_map(StaticValue::Expr),
        op.prop_map(StaticValue::Op),
        unit().prop_map(|unit| StaticValue::Type(TypeKind::Real(Some(unit)).into())),
        Just(StaticValue::Type(
            Type::from(TypeKind::Int).array(Expr::name("n")).optional()
        )),
        name().prop_map(|name| StaticValue::Callee(Callee::synthetic(name, Vec::new()))),
        name().prop_map(|name| {
            let arg = StaticArg::named("n", Expr::int(-3));
            StaticValue::Callee(Callee::synthetic(name, vec![arg]))
        }),
    ];
    let arg = (prop::option::of(ident()), value).prop_map(|(name, value)| StaticArg {
        name,
        value,
        span: rpi_diag::Span::NONE,
    });
    (name(), prop::collection::vec(arg, 0..3))
        .prop_map(|(name, statics)| Callee::synthetic(name, statics))
}

/// Generates activation conditions.
fn activation(inner: impl Strategy<Value = Expr> + Clone) -> impl Strategy<Value = Activation> {
    let (every, restart, default) = (
        inner.clone(),
        prop::option::of(inner.clone()),
        prop::option::of(inner.clone()),
    );
    prop_oneof![
        4 => Just(Activation::Always),
        1 => inner.prop_map(|every| Activation::Restart { every }),
        1 => (every, restart, default).prop_map(|(every, restart, default)| Activation::Activate { every, restart, default }),
    ]
}

/// Generates arguments of a call.
fn args(inner: impl Strategy<Value = Expr>) -> impl Strategy<Value = Vec<Arg>> {
    let arg = (prop::option::of(ident()), inner).prop_map(|(name, value)| Arg { name, value });
    prop::collection::vec(arg, 0..4)
}

/// Generates types.
fn ty() -> impl Strategy<Value = Type> {
    let leaf = prop_oneof![
        Just(Type::from(TypeKind::Bool)),
        Just(TypeKind::Int.into()),
        prop::option::of(unit()).prop_map(|unit| TypeKind::Real(unit).into()),
        name().prop_map(Type::named),
        (name(), name()).prop_map(|(of, in_frame)| {
            let frames = FramePair {
                located: Some(Dotted::synthetic([of])),
                reference: Dotted::synthetic([in_frame]),
            };
            TypeKind::Named(Box::new(NamedType {
                name: Ident::synthetic("Pose"),
                statics: Vec::new(),
                frames: Some(frames),
            }))
            .into()
        }),
    ];
    leaf.prop_recursive(3, 8, 1, |inner| {
        prop_oneof![
            (inner.clone(), expr()).prop_map(|(element, size)| element.array(size)),
            inner.prop_map(Type::optional),
        ]
    })
}

/// Generates declarations of variables.
fn var() -> impl Strategy<Value = VarDecl> {
    let doc = prop::option::of("[a-z]{1,5}(\n[a-z]{0,5})?".prop_map(|doc| Doc::from(doc.as_str())));
    (
        doc,
        prop::collection::vec(ident(), 1..3),
        ty(),
        prop::option::of(clock()),
        prop::option::of(expr()),
    )
        .prop_map(|(doc, names, ty, clock, default)| VarDecl {
            doc,
            is_const: false,
            names,
            ty,
            clock,
            default,
            span: rpi_diag::Span::NONE,
        })
}

/// Generates statements.
fn statement() -> impl Strategy<Value = Statement> {
    let target = (name(), prop::option::of(path(expr()))).prop_map(|(name, path)| {
        let mut target = Target::synthetic(name);
        target.path = path.unwrap_or_default();
        target
    });
    let leaf = prop_oneof![
        (prop::collection::vec(target, 0..3), expr()).prop_map(|(targets, value)| {
            StatementKind::Equation(Box::new(Equation { targets, value }))
        }),
        (callee(expr()), args(expr()))
            .prop_map(|(callee, args)| StatementKind::Call(Box::new(Expr::call(callee, args)))),
        command_end(),
        assertion(),
    ];
    let leaf = leaf.prop_map(Statement::from);
    leaf.prop_recursive(3, 12, 3, |inner| {
        let body = prop::collection::vec(inner, 0..4).prop_map(|statements| Body {
            locals: Vec::new(),
            statements,
        });
        let fragment = (ident(), prop::option::of((expr(), any::<bool>())), body).prop_map(
            |(name, when, body)| {
                let signature = Signature {
                    name,
                    statics: Vec::new(),
                    inputs: None,
                    outputs: None,
                };
                let when = when.map(|(condition, restart)| FragmentWhen {
                    condition,
                    resets: restart,
                });
                FragmentDecl {
                    signature,
                    when,
                    budget: None,
                    contract: None,
                    body,
                }
            },
        );
        fragment.prop_map(|fragment| Statement::from(StatementKind::Fragment(Box::new(fragment))))
    })
}

/// Generates `finish r when c`.
fn command_end() -> impl Strategy<Value = StatementKind> {
    let kind = prop::sample::select(
        &[
            CommandEndKind::Finish,
            CommandEndKind::Yield,
            CommandEndKind::Fail,
        ][..],
    );
    (kind, ident(), expr()).prop_map(|(kind, result, condition)| {
        StatementKind::CommandEnd(Box::new(CommandEnd {
            kind,
            result,
            condition,
        }))
    })
}

/// Generates `assert "label" c`.
fn assertion() -> impl Strategy<Value = StatementKind> {
    (
        prop::option::of("[ -~]{0,5}".prop_map(Ident::synthetic)),
        expr(),
    )
        .prop_map(|(label, condition)| {
            StatementKind::Claim(Box::new(Claim {
                kind: ClaimKind::Assert,
                label,
                condition,
                provided: None,
            }))
        })
}

/// Generates nodes.
fn item() -> impl Strategy<Value = Item> {
    let locals = prop::collection::vec(var(), 1..3).prop_map(Locals::Var);
    let body = (
        prop::collection::vec(locals, 0..2),
        prop::collection::vec(statement(), 0..5),
    )
        .prop_map(|(locals, statements)| Body { locals, statements });
    let node = (
        ident(),
        prop::collection::vec(var(), 0..3),
        prop::collection::vec(var(), 1..3),
        body,
    )
        .prop_map(|(name, inputs, outputs, body)| NodeDecl {
            kind: NodeKind::Node,
            modifier: Modifier::None,
            size_params: Vec::new(),
            signature: Signature {
                name,
                statics: Vec::new(),
                inputs: Some(inputs),
                outputs: Some(outputs),
            },
            contract: None,
            definition: NodeDef::Body(body),
            external_form: ExternalForm::NoBody,
            c_name: None,
        });
    node.prop_map(|node| Item::from(ItemKind::Node(Box::new(node))))
}

/// Generates files.
pub(crate) fn file() -> impl Strategy<Value = File> {
    prop::collection::vec(item(), 0..3).prop_map(|items| File {
        items,
        dialect: Dialect::Rpi,
    })
}
