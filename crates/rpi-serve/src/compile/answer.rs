//! Answer of a worker: the result of a compilation as plain data. The server verifies it.

use std::fmt;
use std::sync::Arc;

use rpi_image::encoding::ReadError;
use rpi_image::plan::{IndexedNode, Target};
use rpi_image::{Image, VerifyError, encode_enum, encode_struct};
use rpi_net::CommandInput;
use rpi_runtime::run::{ExecutablePlan, PlanError};

use super::request::{CompileKind, CompileRequest};
use super::text::{CompileOutput, CompiledCommand};
use crate::state::{PlainCondition, ResultConditions};
use crate::task_bundle::TaskBundle;

/// Answer of a worker to a request.
pub(super) enum Answer {
    /// The text cannot be compiled, for these reasons.
    Rejected(Vec<String>),
    Command(CommandAnswer),
    Task(TaskAnswer),
    /// Structure of a net as XML.
    Structure(String),
}

/// Compiled command. The image is in its file format.
pub(super) struct CommandAnswer {
    image: Vec<u8>,
    work: u64,
    reasons: Vec<(String, PlainCondition)>,
    /// Key of each input to take over, and whether it is required.
    inputs: Vec<(String, bool)>,
}

/// Compiled task. The images are in their file format.
pub(super) struct TaskAnswer {
    images: Vec<Vec<u8>>,
    work: Vec<Option<u64>>,
    nodes: Vec<IndexedNode>,
    start: Target,
}

encode_enum!(Answer { 0 = Rejected(reasons), 1 = Command(command), 2 = Task(task), 3 = Structure(page) });
encode_struct!(CommandAnswer {
    image: Vec<u8>,
    work: u64,
    reasons: Vec<(String, PlainCondition)>,
    inputs: Vec<(String, bool)>,
});
encode_struct!(TaskAnswer { images: Vec<Vec<u8>>, work: Vec<Option<u64>>, nodes: Vec<IndexedNode>, start: Target });

/// Error: the answer of a worker is invalid.
#[derive(Debug)]
pub(crate) enum AnswerError {
    /// It does not begin as an answer does.
    NotAnAnswer,
    /// It has more bytes than this number.
    TooLong(u64),
    /// Its bytes are not an answer or not an image.
    Read(ReadError),
    /// An image was rejected by the verifier, for these reasons.
    Image(Vec<VerifyError>),
    /// The plan of a task is invalid.
    Plan(PlanError),
    /// It answers another request.
    Mismatch,
}

impl Answer {
    /// Creates the answer from the result of a compilation.
    pub(super) fn from_result(result: Result<CompileOutput, Vec<String>>) -> Answer {
        match result {
            Err(reasons) => Answer::Rejected(reasons),
            Ok(CompileOutput::Command(command)) => Answer::Command(CommandAnswer {
                image: command.image.to_bytes(),
                work: command.work,
                reasons: command.reasons.to_plain(),
                inputs: command
                    .takeover_inputs
                    .into_iter()
                    .map(|input| (input.key, input.is_required))
                    .collect(),
            }),
            Ok(CompileOutput::Task(task)) => Answer::Task(TaskAnswer {
                images: task.images.iter().map(|image| image.to_bytes()).collect(),
                work: task.work,
                nodes: task.plan.nodes,
                start: task.plan.start,
            }),
            Ok(CompileOutput::Structure(page)) => Answer::Structure(page),
        }
    }

    /// Verifies the answer to a request and returns its result: the output, or the errors of the text.
    ///
    /// # Errors
    /// If the answer is not valid for the request.
    pub(super) fn verified(
        self,
        request: &CompileRequest,
    ) -> Result<Result<CompileOutput, Vec<String>>, AnswerError> {
        Ok(Ok(match (self, request.kind) {
            (Answer::Rejected(reasons), _) if !reasons.is_empty() => return Ok(Err(reasons)),
            (Answer::Command(answer), CompileKind::Command) => {
                CompileOutput::Command(Box::new(answer.verified(request)?))
            }
            (Answer::Task(answer), CompileKind::Task) => {
                CompileOutput::Task(answer.verified(request)?)
            }
            (Answer::Structure(page), CompileKind::Structure) => CompileOutput::Structure(page),
            _ => return Err(AnswerError::Mismatch),
        }))
    }
}

impl CommandAnswer {
    fn verified(self, request: &CompileRequest) -> Result<CompiledCommand, AnswerError> {
        let inputs = self.inputs.into_iter();
        Ok(CompiledCommand {
            image: verified_image(&self.image, request)?,
            work: self.work,
            reasons: ResultConditions::from_plain(self.reasons),
            takeover_inputs: inputs
                .map(|(key, is_required)| CommandInput { key, is_required })
                .collect(),
        })
    }
}

impl TaskAnswer {
    fn verified(self, request: &CompileRequest) -> Result<TaskBundle, AnswerError> {
        let images = self.images.iter();
        let images = images.map(|bytes| verified_image(bytes, request).map(Arc::new));
        let images: Vec<Arc<Image>> = images.collect::<Result<_, _>>()?;
        let plan = ExecutablePlan {
            nodes: self.nodes,
            start: self.start,
        };
        plan.check(&images).map_err(AnswerError::Plan)?;
        match images.len() == self.work.len() {
            true => Ok(TaskBundle {
                images,
                work: self.work,
                plan,
            }),
            false => Err(AnswerError::Mismatch),
        }
    }
}

/// Decodes and verifies an image, which must have the requested period and tick.
fn verified_image(bytes: &[u8], request: &CompileRequest) -> Result<Image, AnswerError> {
    let image = Image::from_bytes(bytes).map_err(AnswerError::Read)?;
    rpi_image::verify(&image, &rpi_core::prim_desc).map_err(AnswerError::Image)?;
    match (image.period_ns, image.tick_ns) == (request.period_ns, request.tick_ns) {
        true => Ok(image),
        false => Err(AnswerError::Mismatch),
    }
}

impl fmt::Display for AnswerError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            AnswerError::NotAnAnswer => f.write_str("it does not begin as an answer"),
            AnswerError::TooLong(bytes) => write!(f, "it has more than {} MiB", bytes >> 20),
            AnswerError::Read(why) => write!(f, "{why}"),
            AnswerError::Image(errors) => {
                f.write_str("invalid image")?;
                errors.first().map_or(Ok(()), |why| write!(f, ": {why}"))
            }
            AnswerError::Plan(why) => write!(f, "{why}"),
            AnswerError::Mismatch => f.write_str("it answers another request"),
        }
    }
}

impl std::error::Error for AnswerError {}

#[cfg(test)]
mod tests {
    use super::super::frame;
    use super::super::request::{Language, Source};
    use super::super::text::compile_guarded;
    use super::*;

    fn request(kind: CompileKind, language: Language, text: &str) -> CompileRequest {
        CompileRequest {
            kind,
            source: Source {
                language,
                text: text.into(),
                command: None,
                arm_axes: None,
                watch: Vec::new(),
            },
            period_ns: 2_000_000,
            tick_ns: 1_000_000,
        }
    }

    /// Returns the bytes of the answer to a request.
    fn answer(request: &CompileRequest) -> Vec<u8> {
        let answer = Answer::from_result(compile_guarded(request));
        let bytes = frame::frame(frame::FrameLimits::default(), &answer);
        bytes[frame::HEADER_BYTES..].to_vec()
    }

    fn verified(
        bytes: &[u8],
        request: &CompileRequest,
    ) -> Result<Result<CompileOutput, Vec<String>>, AnswerError> {
        let answer: Answer = frame::content(bytes).map_err(AnswerError::Read)?;
        answer.verified(request)
    }

    const NET: &str = "{c=Cancel(),n=Core::BooleanNot(inValue=c.outCancel),\
        x=Core::BooleanNetcommOut(inValue=n.outValue,Key='_1'),\
        y=Core::BooleanNetcommOut(inValue=c.outCancel,Key='_2')}";

    const TASK: &str = "command Wait () let finish done when time >= 1[s]; tel\n\
        task Main () let Wait(); Wait(); tel\n";

    #[test]
    fn an_answer_is_the_output_of_the_compilation() {
        let all = [
            request(CompileKind::Command, Language::Rpinet, NET),
            request(CompileKind::Structure, Language::Rpinet, NET),
            request(CompileKind::Command, Language::Rpinet, "{a=B()}"),
            request(CompileKind::Command, Language::Rpi, TASK),
            request(CompileKind::Task, Language::Rpi, TASK),
        ];
        for request in all {
            let expected = compile_guarded(&request);
            assert_eq!(verified(&answer(&request), &request).unwrap(), expected);
        }
    }

    #[test]
    fn an_answer_to_another_request_is_rejected() {
        let command = request(CompileKind::Command, Language::Rpi, TASK);
        let task = request(CompileKind::Task, Language::Rpi, TASK);
        let other_period = CompileRequest {
            period_ns: 1_000_000,
            ..command.clone()
        };
        for (requested, answered) in [
            (&command, &task),
            (&task, &command),
            (&other_period, &command),
        ] {
            let verdict = verified(&answer(answered), requested);
            assert!(matches!(verdict, Err(AnswerError::Mismatch)), "{verdict:?}");
        }
    }

    /// Nothing in an answer makes the server panic, even if the checksums of the images are right.
    #[test]
    fn a_damaged_answer_is_an_error_or_another_answer() {
        for (kind, language, text) in [
            (CompileKind::Command, Language::Rpinet, NET),
            (CompileKind::Task, Language::Rpi, TASK),
        ] {
            let request = request(kind, language, text);
            let answer = answer(&request);
            for at in 0..answer.len() {
                for value in [0, 1, 0x7f, 0xff] {
                    let mut damaged = answer.clone();
                    damaged[at] = value;
                    let _ = verified(&damaged, &request);
                }
                assert!(verified(&answer[..at], &request).is_err());
            }
        }
    }
}
