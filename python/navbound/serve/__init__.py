"""Pages of this host for its own browser: the one server of the live display and of the workbench.

`request` reads and answers HTTP and decides who may ask; `hub` keeps what each page has still to receive; `service` joins them to a server
whose pages, questions and news are those of its owner.
"""
