use super::*;

#[test]
fn a_kind_is_known_by_its_id() {
    for kind in Kind::ALL {
        assert_eq!(Kind::of(kind.id()), Some(kind));
    }
    assert_eq!(Kind::of("rtcm"), None);
}
