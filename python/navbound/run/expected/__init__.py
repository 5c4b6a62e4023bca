"""A flight before it is flown.

A plan becomes a scenario and windows (`setup`), an epoch table by covariance (`table`), legs and holes (`legs`), the time without aids
(`hold`); `flight` puts them together and `page` shows them, `assess` compares with flights that followed.
"""
