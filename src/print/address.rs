//! Where a printer is: `ipp://host[:port][/path]` (RFC 3510, RFC 7472).

use std::fmt;

use hyper::http::Uri;

/// The port of printers.
const PORT: u16 = 631;

/// Where printers of PWG 5100.14 are, if nothing else is said.
const PATH: &str = "/ipp/print";

/// Bytes of an address, as IPP bounds a URI.
const LONGEST: usize = 1023;

/// The address of a printer or of one of its jobs.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Address {
    /// Without the brackets of IPv6.
    host: String,
    port: u16,
    /// Begins with `/`; a query may follow.
    path: String,
}

impl Address {
    /// Reads an address. Without a path it is that of PWG 5100.14, `/ipp/print`.
    ///
    /// # Errors
    /// What is wrong, and what to give.
    pub fn parse(text: &str) -> Result<Address, String> {
        let wrong = |what: &str| Err(format!("{what}: give a printer's address such as ipp://printer.local/ipp/print"));
        if text.len() > LONGEST {
            return wrong("the address is longer than 1023 bytes");
        }
        let Ok(uri) = text.parse::<Uri>() else { return wrong("this is no address") };
        let port = match uri.scheme_str().map(str::to_ascii_lowercase).as_deref() {
            Some("ipp") => PORT,
            Some("http") => 80,
            Some("ipps" | "https") => {
                return Err("printing over TLS (ipps) is not built in: give the printer's ipp:// address".to_owned());
            }
            Some(_) => return wrong("only ipp:// is understood"),
            None => return wrong("the address has no scheme"),
        };
        let Some(authority) = uri.authority() else { return wrong("the address names no host") };
        if authority.as_str().contains('@') {
            return wrong("names and passwords in an address are not sent");
        }
        let host = authority.host().trim_start_matches('[').trim_end_matches(']').to_owned();
        let bad_port = authority.as_str().rsplit_once(':').is_some_and(|(_, port)| !port.contains(']') && authority.port_u16().is_none());
        if host.is_empty() || bad_port || authority.port_u16() == Some(0) {
            return wrong("the address names no host and port");
        }
        let path = uri.path_and_query().map_or("", |path| path.as_str());
        let path = if matches!(path, "" | "/") { PATH } else { path };
        Ok(Address { host, port: authority.port_u16().unwrap_or(port), path: path.to_owned() })
    }

    /// The host, for the resolver.
    pub fn host(&self) -> &str {
        &self.host
    }

    /// The port.
    pub fn port(&self) -> u16 {
        self.port
    }

    /// What follows the host in a request.
    pub fn path(&self) -> &str {
        &self.path
    }

    /// What the `Host` of a request says.
    pub fn authority(&self) -> String {
        if self.host.contains(':') { format!("[{}]:{}", self.host, self.port) } else { format!("{}:{}", self.host, self.port) }
    }

    /// The same host and port with another path. What is none is left out.
    #[must_use]
    pub fn with_path(&self, path: &str) -> Address {
        let path = if path.starts_with('/') { path.to_owned() } else { self.path.clone() };
        Address { path, ..self.clone() }
    }
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let authority = self.authority();
        let authority = if self.port == PORT { authority.strip_suffix(":631").unwrap_or(&authority) } else { &authority };
        write!(f, "ipp://{authority}{}", self.path)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses() {
        for (text, expected) in [
            ("ipp://printer", "ipp://printer/ipp/print"),
            ("IPP://printer:631/", "ipp://printer/ipp/print"),
            ("ipp://printer.local:8631/ipp/print/3", "ipp://printer.local:8631/ipp/print/3"),
            ("http://10.0.0.7:631/printers/a?b=c", "ipp://10.0.0.7/printers/a?b=c"),
            ("http://10.0.0.7/x", "ipp://10.0.0.7:80/x"),
            ("ipp://[fe80::1]:99/ipp", "ipp://[fe80::1]:99/ipp"),
            ("ipp://[::1]", "ipp://[::1]/ipp/print"),
        ] {
            assert_eq!(Address::parse(text).map(|address| address.to_string()).as_deref(), Ok(expected), "{text}");
        }
        assert_eq!(Address::parse("ipp://[::1]").unwrap().host(), "::1");
        for text in [
            "",
            "printer",
            "ipp://",
            "ipp:///x",
            "ipp://a:0/",
            "ipp://a:x/",
            "ipp://a:70000/",
            "ipp://u:p@a/",
            "lpd://a/",
            "ipp://a b/",
            "file:///x",
        ] {
            assert!(Address::parse(text).is_err(), "{text}");
        }
        assert!(Address::parse("ipps://printer/").unwrap_err().contains("TLS"));
        assert!(Address::parse(&format!("ipp://a/{}", "x".repeat(2000))).is_err());
    }
}
