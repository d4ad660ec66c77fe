//! Which requests are answered: those that this machine's own page has sent, and programs of it.
//!
//! A page of another site may not read what is shown here, nor change it. A name that points to this machine is not enough, as
//! whoever owns a name may have it point here (rebinding of DNS): `Host` must be the address that the page was served from. A request
//! that comes from a page must come from this one (`Origin`, `Sec-Fetch-Site`); one that changes something must be JSON as well, which
//! pages of other sites cannot send without asking first, and are refused when they ask.

/// What a request says of itself.
#[derive(Clone, Debug, Default)]
pub struct Claims<'a> {
    /// Would it change something?
    pub changes: bool,
    /// Is it for the page itself, which any link may lead to?
    pub page: bool,
    /// `Host`.
    pub host: Option<&'a str>,
    /// `Origin`.
    pub origin: Option<&'a str>,
    /// `Sec-Fetch-Site`.
    pub site: Option<&'a str>,
    /// `Content-Type`.
    pub content: Option<&'a str>,
}

/// Why a request is refused, if it is.
pub fn refused(claims: &Claims, port: u16) -> Option<&'static str> {
    let names = ["127.0.0.1", "localhost"];
    let own = |text: &str| {
        let text = text.to_ascii_lowercase();
        names.iter().any(|name| text == format!("{name}:{port}") || (port == 80 && text == *name))
    };
    if !claims.host.is_some_and(own) {
        return Some("this host is not served here");
    }
    let own_origin = |origin: &str| origin.strip_prefix("http://").is_some_and(own);
    if claims.origin.is_some_and(|origin| !own_origin(origin)) {
        return Some("pages of other sites are not answered");
    }
    if !claims.page && claims.site.is_some_and(|site| !["same-origin", "none"].contains(&site)) {
        return Some("pages of other sites are not answered");
    }
    let json = |kind: &str| kind.split(';').next().is_some_and(|kind| kind.trim() == "application/json");
    if claims.changes && !claims.content.is_some_and(json) {
        return Some("what changes something is sent as application/json");
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn own() -> Claims<'static> {
        Claims { host: Some("127.0.0.1:7345"), ..Claims::default() }
    }

    #[test]
    fn only_this_machines_own_page_is_answered() {
        assert_eq!(refused(&own(), 7345), None);
        assert_eq!(refused(&Claims { host: Some("LOCALHOST:7345"), ..own() }, 7345), None);
        assert_eq!(refused(&Claims { host: Some("localhost"), ..own() }, 80), None);
        for host in
            [None, Some(""), Some("127.0.0.1"), Some("127.0.0.1:80"), Some("evil.example:7345"), Some("0.0.0.0:7345")]
        {
            assert!(refused(&Claims { host, ..own() }, 7345).is_some(), "{host:?}");
        }
    }

    #[test]
    fn other_pages_change_nothing() {
        let change = || Claims { changes: true, content: Some("application/json"), ..own() };
        assert_eq!(refused(&change(), 7345), None);
        assert_eq!(refused(&Claims { origin: Some("http://127.0.0.1:7345"), ..change() }, 7345), None);
        let other =
            ["null", "http://evil.example", "http://127.0.0.1:1234", "https://127.0.0.1:7345", "http://127.0.0.1"];
        for origin in other {
            assert!(refused(&Claims { origin: Some(origin), ..change() }, 7345).is_some(), "{origin}");
        }
        assert!(refused(&Claims { content: Some("text/plain"), ..change() }, 7345).is_some());
        assert!(refused(&Claims { content: None, ..change() }, 7345).is_some());
        for site in ["cross-site", "same-site"] {
            assert!(refused(&Claims { site: Some(site), ..change() }, 7345).is_some());
            assert!(refused(&Claims { site: Some(site), page: true, ..own() }, 7345).is_none());
        }
    }
}
