"""The fault campaign: every kind of sensor fault, in sizes, at times, on flights; how often a position called good was not.

``kinds`` lists the faults, ``study`` flies them, ``records`` holds what came out, ``table`` lays it out for the terminal and the page.
"""
