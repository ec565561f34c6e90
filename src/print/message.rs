//! Requests and answers of IPP (RFC 8010). The `ipp` crate encodes and decodes them; an answer is looked through before, because it comes from outside:
//! its parser would follow any depth and any number of values.

use std::collections::BTreeMap;

use bytes::Bytes;
use ipp::IppHeader;
use ipp::attribute::{IppAttribute, IppAttributes};
use ipp::model::{DelimiterTag, IppVersion, Operation, StatusCode};
use ipp::parser::IppParser;
use ipp::reader::IppReader;
use ipp::value::{BoundedString, IppName, IppTextValue, IppValue};

use super::address::Address;
use super::failure::{Failure, Why};

/// Collections within collections.
const DEEPEST: usize = 16;

/// Values of an answer, those of collections too.
const MOST_VALUES: usize = 200_000;

/// A request without its document.
pub struct Request {
    header: IppHeader,
    attributes: IppAttributes,
}

impl Request {
    /// A request to a printer or a job; `target` says which (`printer-uri`, `job-uri`).
    pub fn new(operation: Operation, target: &str, address: &Address) -> Request {
        // Every printer of a later version takes 1.1 too (RFC 8011, section 5.4.14).
        let header = IppHeader::new(IppVersion::v1_1(), operation as i16, 1);
        let request = Request { header, attributes: IppAttributes::new() };
        request
            .with("attributes-charset", IppValue::Charset(cut("utf-8")))
            .with("attributes-natural-language", IppValue::NaturalLanguage(cut("en")))
            .with(target, IppValue::Uri(cut(&address.to_string())))
    }

    /// With an attribute of the operation.
    #[must_use]
    pub fn with(mut self, key: &str, value: IppValue) -> Request {
        self.attributes.add(DelimiterTag::OperationAttributes, IppAttribute::new(name(key), value));
        self
    }

    /// With attributes of a job.
    #[must_use]
    pub fn with_job(mut self, attributes: &[(String, IppValue)]) -> Request {
        for (key, value) in attributes {
            self.attributes.add(DelimiterTag::JobAttributes, IppAttribute::new(name(key), value.clone()));
        }
        self
    }

    /// As it is sent.
    pub fn bytes(&self) -> Bytes {
        [self.header.to_bytes(), self.attributes.to_bytes()].concat().into()
    }
}

/// Text that fits into a bound, cut between characters.
fn cut<const MAX: usize>(text: &str) -> BoundedString<MAX> {
    let mut end = text.len().min(MAX);
    while !text.is_char_boundary(end) {
        end -= 1;
    }
    BoundedString::new(&text[..end]).expect("it was cut")
}

fn name(text: &str) -> IppName {
    cut(text)
}

/// A keyword.
pub fn keyword(text: &str) -> IppValue {
    IppValue::Keyword(cut(text))
}

/// A name for people.
pub fn title(text: &str) -> IppValue {
    IppValue::NameWithoutLanguage(cut(text))
}

/// A media type.
pub fn media_type(text: &str) -> IppValue {
    IppValue::MimeMediaType(cut(text))
}

/// Several keywords.
pub fn keywords(list: &[&str]) -> IppValue {
    IppValue::Array(list.iter().map(|text| keyword(text)).collect())
}

/// A collection.
pub fn collection(members: impl IntoIterator<Item = (&'static str, IppValue)>) -> IppValue {
    IppValue::Collection(members.into_iter().map(|(key, value)| (name(key), value)).collect::<BTreeMap<_, _>>())
}

/// An answer.
#[derive(Debug)]
pub struct Answer {
    /// RFC 8011, appendix B.
    pub status: u16,
    message: Groups,
}

/// Groups of attributes, in their order.
type Groups = Vec<(DelimiterTag, Vec<(String, IppValue)>)>;

impl Answer {
    /// Reads an answer.
    ///
    /// # Errors
    /// It breaks off, is no IPP, or is past a limit.
    pub fn read(bytes: Bytes) -> Result<Answer, Failure> {
        look_through(&bytes).map_err(malformed)?;
        let parser = IppParser::new(IppReader::new(std::io::Cursor::new(bytes)));
        let (header, attributes, _) = parser.parse_parts().map_err(|error| malformed(error.to_string()))?;
        let groups = attributes.into_groups().into_iter().map(|group| {
            let tag = group.tag();
            (tag, group.into_attributes().into_iter().map(|a| (a.name().as_str().to_owned(), a.into_value())).collect())
        });
        Ok(Answer { status: header.operation_or_status as u16, message: groups.collect() })
    }

    /// Whether what was asked for is done.
    pub fn is_success(&self) -> bool {
        self.status < 0x0100
    }

    /// Attributes of the first group of a kind.
    pub fn group(&self, tag: DelimiterTag) -> Attributes<'_> {
        Attributes(self.message.iter().find(|(of, _)| *of == tag).map_or(&[], |(_, list)| list))
    }

    /// Attributes of a printer.
    pub fn printer(&self) -> Attributes<'_> {
        self.group(DelimiterTag::PrinterAttributes)
    }

    /// Attributes of a job.
    pub fn job(&self) -> Attributes<'_> {
        self.group(DelimiterTag::JobAttributes)
    }

    /// What an answer that is no success says, in words: the status, the printer's own message, and the attributes that it does not take.
    pub fn complaint(&self) -> String {
        let mut text = status_name(self.status);
        if let Some(message) = self.group(DelimiterTag::OperationAttributes).text("status-message") {
            text.push_str(&format!(" ({message})"));
        }
        let refused: Vec<String> =
            self.group(DelimiterTag::UnsupportedAttributes).0.iter().map(|(name, value)| told(name, value)).collect();
        if !refused.is_empty() {
            text.push_str(&format!(": it does not take {}", refused.join(", ")));
        }
        text
    }
}

/// Attributes of a group.
#[derive(Clone, Copy)]
pub struct Attributes<'a>(pub(super) &'a [(String, IppValue)]);

impl<'a> Attributes<'a> {
    /// The values of an attribute; none if it is not there.
    pub fn values(self, name: &str) -> &'a [IppValue] {
        match self.0.iter().find(|(own, _)| own == name) {
            Some((_, IppValue::Array(values))) => values,
            Some((_, value)) => std::slice::from_ref(value),
            None => &[],
        }
    }

    /// Its first value as text.
    pub fn text(self, name: &str) -> Option<&'a str> {
        self.values(name).first().and_then(text).filter(|text| !text.is_empty())
    }

    /// All its values that are text.
    pub fn texts(self, name: &str) -> Vec<String> {
        self.values(name).iter().filter_map(text).map(str::to_owned).collect()
    }

    /// Its first value as a number.
    pub fn number(self, name: &str) -> Option<i32> {
        self.values(name).first().and_then(number)
    }
}

/// A value that is text of whatever kind.
pub fn text(value: &IppValue) -> Option<&str> {
    match value {
        IppValue::Keyword(text) => Some(text.as_str()),
        IppValue::NameWithoutLanguage(text) | IppValue::NameWithLanguage { name: text, .. } => Some(text.as_str()),
        IppValue::TextWithoutLanguage(text) | IppValue::TextWithLanguage { text, .. } => Some(IppTextValue::as_ref(text)),
        IppValue::Uri(text) | IppValue::UriScheme(text) => Some(text.as_str()),
        IppValue::MimeMediaType(text) => Some(text.as_str()),
        _ => None,
    }
}

/// A value that is a number.
pub fn number(value: &IppValue) -> Option<i32> {
    match value {
        IppValue::Integer(n) | IppValue::Enum(n) => Some(*n),
        _ => None,
    }
}

/// A value that is a number or a range of numbers.
pub fn range(value: &IppValue) -> Option<(i32, i32)> {
    match value {
        IppValue::RangeOfInteger { min, max } => Some((*min, *max)).filter(|(min, max)| min <= max),
        value => number(value).map(|n| (n, n)),
    }
}

/// A member of a collection.
pub fn member<'a>(value: &'a IppValue, name: &str) -> Option<&'a IppValue> {
    let IppValue::Collection(members) = value else { return None };
    members.get(name)
}

fn told(name: &str, value: &IppValue) -> String {
    match (text(value), number(value)) {
        (Some(text), _) => format!("{name}={text}"),
        (_, Some(number)) => format!("{name}={number}"),
        _ => name.to_owned(),
    }
}

/// A status as RFC 8011 names it.
fn status_name(status: u16) -> String {
    use num_traits::FromPrimitive as _;
    let code = StatusCode::from_u16(status).unwrap_or(StatusCode::UnknownStatusCode);
    if code == StatusCode::UnknownStatusCode {
        return format!("status {status:#06x}");
    }
    let mut name = String::new();
    for c in format!("{code:?}").chars() {
        if c.is_ascii_uppercase() && !name.is_empty() {
            name.push('-');
        }
        name.push(c.to_ascii_lowercase());
    }
    name
}

fn malformed(what: impl Into<String>) -> Failure {
    Failure::new(Why::Malformed, format!("the printer's answer is no IPP: {}", what.into()))
}

/// The first so many bytes, as the two before them say, and what follows.
fn counted(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let (length, rest) = bytes.split_first_chunk()?;
    rest.split_at_checked(usize::from(u16::from_be_bytes(*length)))
}

/// Whether an answer has the form of one, within the limits: a head of 8 bytes, groups of attributes, an end.
fn look_through(bytes: &[u8]) -> Result<(), String> {
    let broken = |at: usize| format!("it breaks off at byte {at}");
    let mut rest = bytes.get(8..).ok_or_else(|| broken(bytes.len()))?;
    let (mut depth, mut values) = (0_usize, 0);
    loop {
        let (tag, behind) = rest.split_first().ok_or_else(|| broken(bytes.len()))?;
        let at = bytes.len() - rest.len();
        rest = behind;
        match tag {
            0x03 if depth == 0 => return Ok(()),
            0x01..=0x0a if depth == 0 => continue,
            0x10..=0x4a => {}
            _ => return Err(format!("byte {at} is {tag:#04x}")),
        }
        // A name and a value, each behind its length.
        let mut part: &[u8] = &[];
        for _ in 0..2 {
            (part, rest) = counted(rest).ok_or_else(|| broken(bytes.len()))?;
        }
        // A language and a text, each behind its length: the parser takes that for granted.
        if matches!(tag, 0x35 | 0x36) && counted(part).and_then(|(_, text)| counted(text)).is_none() {
            return Err(format!("a text with its language is cut short before byte {}", bytes.len() - rest.len()));
        }
        values += 1;
        match tag {
            0x34 => depth += 1,
            0x37 => depth = depth.checked_sub(1).ok_or_else(|| format!("a collection ends at byte {at} that did not begin"))?,
            _ => {}
        }
        if depth > DEEPEST || values > MOST_VALUES {
            return Err(format!("more than {DEEPEST} collections within each other, or more than {MOST_VALUES} values"));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// An answer by hand: two printer attributes, one with two values, one a collection (RFC 8010, section 3.1).
    fn answer() -> Vec<u8> {
        let mut bytes = vec![1, 1, 0, 0, 0, 0, 0, 1, 0x01];
        let mut attribute = |tag: u8, name: &str, value: &[u8]| {
            bytes.push(tag);
            for part in [name.as_bytes(), value] {
                bytes.extend(u16::try_from(part.len()).unwrap().to_be_bytes());
                bytes.extend(part);
            }
        };
        attribute(0x47, "attributes-charset", b"utf-8");
        attribute(0x48, "attributes-natural-language", b"en");
        bytes.push(0x04);
        let mut attribute = |tag: u8, name: &str, value: &[u8]| {
            bytes.push(tag);
            for part in [name.as_bytes(), value] {
                bytes.extend(u16::try_from(part.len()).unwrap().to_be_bytes());
                bytes.extend(part);
            }
        };
        attribute(0x44, "media-ready", b"iso_a4_210x297mm");
        attribute(0x44, "", b"na_letter_8.5x11in");
        attribute(0x34, "media-col-default", b"");
        attribute(0x4a, "", b"media-size");
        attribute(0x34, "", b"");
        attribute(0x4a, "", b"x-dimension");
        attribute(0x21, "", &21000_i32.to_be_bytes());
        attribute(0x4a, "", b"y-dimension");
        attribute(0x33, "", &[0, 0, 0, 1, 0, 0, 0, 9]);
        attribute(0x37, "", b"");
        attribute(0x37, "", b"");
        bytes.push(0x03);
        bytes
    }

    #[test]
    fn an_answer_by_hand() {
        let answer = Answer::read(answer().into()).unwrap();
        assert!(answer.is_success());
        assert_eq!(answer.printer().texts("media-ready"), ["iso_a4_210x297mm", "na_letter_8.5x11in"]);
        let size = member(&answer.printer().values("media-col-default")[0], "media-size").unwrap();
        assert_eq!(member(size, "x-dimension").and_then(range), Some((21000, 21000)));
        assert_eq!(member(size, "y-dimension").and_then(range), Some((1, 9)));
    }

    #[test]
    fn every_cut_and_every_byte_is_refused_or_read() {
        let whole = answer();
        for end in 0..whole.len() {
            let failure = Answer::read(Bytes::copy_from_slice(&whole[..end])).unwrap_err();
            assert_eq!((failure.why, failure.what.lines().count()), (Why::Malformed, 1), "{end}");
        }
        for at in 0..whole.len() {
            for byte in [0, 3, 0x34, 0x37, 0x4a, 0x7f, 0xff] {
                let mut bent = whole.clone();
                bent[at] = byte;
                let _ = Answer::read(bent.into());
            }
        }
    }

    #[test]
    fn collections_without_end_are_refused() {
        let mut deep = vec![1, 1, 0, 0, 0, 0, 0, 1, 0x04];
        deep.extend([0x34, 0, 1, b'a', 0, 0]);
        deep.extend([0x34, 0, 0, 0, 0].repeat(800_000));
        deep.extend([0x37, 0, 0, 0, 0].repeat(800_001));
        deep.push(3);
        assert!(Answer::read(deep.into()).unwrap_err().what.contains("16 collections"));
        let mut many = vec![1, 1, 0, 0, 0, 0, 0, 1, 0x04];
        many.extend([0x44, 0, 1, b'a', 0, 0].repeat(MOST_VALUES + 1));
        many.push(3);
        assert!(Answer::read(many.into()).unwrap_err().what.contains("200000 values"));
    }

    #[test]
    fn a_text_that_is_shorter_than_it_says_is_refused() {
        for value in [&[0xff, 0xff, b'e'][..], &[0], &[], &[0, 2, b'e', b'n', 0, 9, b'x']] {
            let mut bytes = vec![1, 1, 0, 0, 0, 0, 0, 1, 0x04, 0x35, 0, 1, b'a', 0, value.len() as u8];
            bytes.extend(value);
            bytes.push(3);
            assert!(Answer::read(bytes.into()).unwrap_err().what.contains("cut short"));
        }
    }

    proptest! {
        #[test]
        fn garbage_is_refused_or_read(bytes in prop::collection::vec(any::<u8>(), 0..400), tags in prop::collection::vec(0x30_u8..0x4b, 0..40)) {
            let _ = Answer::read(bytes.clone().into());
            let mut framed = vec![1, 1, 0, 0, 0, 0, 0, 1, 0x04];
            for (i, tag) in tags.into_iter().enumerate() {
                framed.extend([tag, 0, u8::from(i == 0)]);
                framed.extend(&b"n"[..usize::from(i == 0)]);
                let value = &bytes[..(i * 3 % 12).min(bytes.len())];
                framed.extend([0, value.len() as u8]);
                framed.extend(value);
            }
            framed.push(3);
            let _ = Answer::read(framed.into());
        }
    }

    #[test]
    fn statuses_have_their_names() {
        assert_eq!(status_name(0x0507), "server-error-busy");
        assert_eq!(status_name(0x040b), "client-error-attributes-or-values-not-supported");
        assert_eq!(status_name(0x0599), "status 0x0599");
    }
}
