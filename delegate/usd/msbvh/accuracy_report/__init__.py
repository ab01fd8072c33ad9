"""The HTML report of `msbvh accuracy`: one page that needs no network and no file beside it."""
