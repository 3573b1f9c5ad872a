//! OpenSubdiv's evaluators in a process of their own, so that whatever ends them ends nothing else.
//!
//! A worker is this program again. It reads the mesh from its standard input, then questions, and writes answers to its standard
//! output: each as eight bytes of length, least significant first, and as many bytes of data (postcard). It ends with its input.

use super::oracle::{Answer, Oracle, Question};
use super::{Process, ReferenceError};
use crate::mesh::SubdivMesh;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::io::{self, BufReader, BufWriter, Read, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, ExitStatus, Stdio};

/// A worker, seen from the process that started it.
#[derive(Debug)]
pub(super) struct Worker {
    child: Child,
    questions: BufWriter<ChildStdin>,
    answers: BufReader<ChildStdout>,
}

impl Worker {
    /// Starts a worker and gives it the mesh.
    ///
    /// # Errors
    /// The program cannot be started.
    pub fn start(process: &Process, mesh: &SubdivMesh) -> Result<Self, ReferenceError> {
        let Process::Worker { program, arguments, threads } = process else {
            return Err(ReferenceError::NoWorker("there is no program for it".to_owned()));
        };
        let mut command = Command::new(program);
        command.args(arguments).env("RAYON_NUM_THREADS", threads.to_string());
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null());
        let no_worker = |error: io::Error| ReferenceError::NoWorker(format!("{}: {error}", program.display()));
        let mut child = command.spawn().map_err(no_worker)?;
        let (Some(stdin), Some(stdout)) = (child.stdin.take(), child.stdout.take()) else {
            return Err(no_worker(io::ErrorKind::BrokenPipe.into()));
        };
        let mut worker = Self { child, questions: BufWriter::new(stdin), answers: BufReader::new(stdout) };
        match write(&mut worker.questions, mesh) {
            Ok(()) => Ok(worker),
            Err(_) => Err(worker.end()),
        }
    }

    /// Asks, and waits for the answer.
    ///
    /// # Errors
    /// OpenSubdiv reports an error, or the process ends; it cannot be asked again then.
    pub fn ask(&mut self, question: &Question) -> Result<Answer, ReferenceError> {
        let answer =
            write(&mut self.questions, question).and_then(|()| read::<Result<Answer, String>>(&mut self.answers));
        match answer {
            Ok(Some(answer)) => answer.map_err(ReferenceError::Reported),
            Ok(None) | Err(_) => Err(self.end()),
        }
    }

    /// How the process ended, which says neither its input nor its output any more.
    fn end(&mut self) -> ReferenceError {
        // One that broke the protocol is still there.
        let _ = self.child.kill();
        match self.child.wait() {
            Ok(status) => ReferenceError::Ended(describe(status)),
            Err(error) => ReferenceError::Ended(error.to_string()),
        }
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        // What it is doing nobody waits for.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[cfg(unix)]
fn describe(status: ExitStatus) -> String {
    use std::os::unix::process::ExitStatusExt;
    match (status.signal(), status.code()) {
        (Some(signal), _) => match signal_hook::low_level::signal_name(signal) {
            Some(name) => name.to_owned(),
            None => format!("signal {signal}"),
        },
        (None, Some(code)) => format!("exit code {code}"),
        (None, None) => status.to_string(),
    }
}

#[cfg(not(unix))]
fn describe(status: ExitStatus) -> String {
    status.to_string()
}

/// Answers questions until there are no more: what a program does that is started as a worker ([`Process::Worker`]). Nothing else
/// may be written to `answers`.
///
/// # Errors
/// Input that is no question, or an output that cannot be written.
pub fn serve(questions: impl Read, answers: impl Write) -> io::Result<()> {
    let (mut questions, mut answers) = (BufReader::new(questions), BufWriter::new(answers));
    let Some(mesh) = read::<SubdivMesh>(&mut questions)? else { return Ok(()) };
    let mut oracle = Oracle::new(mesh);
    while let Some(question) = read::<Question>(&mut questions)? {
        write(&mut answers, &oracle.answer(question).map_err(|error| error.to_string()))?;
    }
    Ok(())
}

/// Bytes that are expected of an answer: those of a million samples.
const ROOM: u64 = 100 << 20;

fn write(out: &mut impl Write, value: &impl Serialize) -> io::Result<()> {
    let data = postcard::to_stdvec(value).map_err(io::Error::other)?;
    out.write_all(&(data.len() as u64).to_le_bytes())?;
    out.write_all(&data)?;
    out.flush()
}

/// The next value; `None` where the input ends before it.
fn read<T: DeserializeOwned>(input: &mut impl Read) -> io::Result<Option<T>> {
    let mut length = [0; 8];
    match input.read_exact(&mut length) {
        Ok(()) => {}
        Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => return Ok(None),
        Err(error) => return Err(error),
    }
    let length = u64::from_le_bytes(length);
    // A length may be anything, so only so much room is taken before the data comes.
    let mut data = Vec::with_capacity(length.min(ROOM) as usize);
    if input.take(length).read_to_end(&mut data)? as u64 != length {
        return Err(io::ErrorKind::UnexpectedEof.into());
    }
    postcard::from_bytes(&data).map(Some).map_err(io::Error::other)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh;

    #[test]
    fn questions_are_answered_in_order_until_the_input_ends() {
        let mut input = Vec::new();
        write(&mut input, &mesh::sample()).expect("memory takes all");
        let samples = vec![(0, 0.25, 0.5), (1, 0.5, 0.5)];
        write(&mut input, &Question::Far(samples.clone())).expect("memory takes all");
        write(&mut input, &Question::Bfr { levels: (0, 99), samples }).expect("memory takes all");
        let mut output = Vec::new();
        serve(&input[..], &mut output).expect("it answers");
        let mut output = &output[..];
        let answers: [Result<Answer, String>; 2] =
            [(); 2].map(|()| read(&mut output).expect("whole").expect("there are two"));
        assert!(matches!(&answers[0], Ok(Answer::Jets(jets)) if jets.len() == 2), "{answers:?}");
        assert!(matches!(&answers[1], Err(error) if error.contains("1 to 10")), "{answers:?}");
        assert!(output.is_empty());
    }

    #[test]
    fn input_that_is_cut_off_is_an_error() {
        let mut input = Vec::new();
        write(&mut input, &mesh::sample()).expect("memory takes all");
        assert!(serve(&input[..input.len() - 1], io::sink()).is_err());
        assert!(serve(&input[..0], io::sink()).is_ok());
    }
}
