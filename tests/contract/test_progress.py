from splatline.contract.progress import part_of


def test_the_share_of_a_part_lies_within_the_whole():
    told = []
    tell = part_of(told.append, 0.5, 0.75)
    for share in (0.0, 0.5, 1.0):
        tell(share)
    assert told == [0.5, 0.625, 0.75]


def test_nobody_is_told_where_nobody_asks():
    assert part_of(None, 0.0, 1.0) is None
